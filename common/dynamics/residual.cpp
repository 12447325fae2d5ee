#include "common/dynamics/residual.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "common/core/limits.h"
#include "common/dynamics/force_pass.h"

namespace softgrain {

namespace {

/// Whether x is worse than what was seen so far. Not a number is worst of all, and stays so.
bool exceeds(double x, double worst) { return !(x <= worst) && !std::isnan(worst); }

template <int D>
double net_force2(const Particles<D>& p, std::size_t u) {
  const double f2 = p.inverse_mass[u] > 0.0 ? norm2(p.force[u]) : 0.0;
  if (!(p.inverse_inertia[u] > 0.0)) return f2;
  const double m2 = norm2(p.torque[u]) / (p.sphere[u].r * p.sphere[u].r);
  return exceeds(m2, f2) ? m2 : f2;
}

/// The largest of all but a share of them, rounded down; what is not a number is never left out.
double largest_but_for(std::vector<double> all, double but_for) {
  const auto left_out = static_cast<std::ptrdiff_t>(but_for * static_cast<double>(all.size()));
  const auto wrong = std::find_if(all.begin(), all.end(), [](double x) { return !std::isfinite(x); });
  if (wrong != all.end()) return *wrong;
  if (all.empty()) return 0.0;
  const auto worst = all.end() - 1 - std::max<std::ptrdiff_t>(left_out, 0);
  std::nth_element(all.begin(), worst, all.end());
  return *worst;
}

template <int D>
double smaller_radius(const System<D>& s, const ContactRecord<D>& c) {
  const double ri = s.particles.sphere[static_cast<std::size_t>(c.i)].r;
  return c.j < s.particles.grains ? std::min(ri, s.particles.sphere[static_cast<std::size_t>(c.j)].r) : ri;
}

}  // namespace

template <int D>
double worst_net_force(const Particles<D>& p) {
  double worst = 0.0;
  for (std::size_t u = 0; u < p.force.size(); ++u) {
    const double f2 = net_force2(p, u);
    if (exceeds(f2, worst)) worst = f2;
  }
  return std::sqrt(worst);
}

template <int D>
double worst_net_force(const Particles<D>& p, double but_for) {
  if (static_cast<std::ptrdiff_t>(but_for * static_cast<double>(p.force.size())) <= 0) return worst_net_force(p);
  std::vector<double> all(p.force.size());
  for (std::size_t u = 0; u < all.size(); ++u) all[u] = net_force2(p, u);
  return std::sqrt(largest_but_for(std::move(all), but_for));
}

template <int D>
double ForceScale::of(double r) const {
  constexpr double kShare = (D == 3 ? 4.0 : 2.0) * std::numbers::pi / 6.0;
  return std::max(mean, kShare * own_stress * (D == 3 ? r * r : r));
}

template <int D>
double worst_net_force(const Particles<D>& p, const ForceScale& scale, double but_for) {
  if (!(scale.own_stress > 0.0 && scale.mean > 0.0)) return worst_net_force(p, but_for);
  std::vector<double> all(p.force.size());
  for (std::size_t u = 0; u < all.size(); ++u)
    all[u] = std::sqrt(net_force2(p, u)) * (scale.mean / scale.of<D>(p.sphere[u].r));
  return largest_but_for(std::move(all), but_for);
}

template <int D>
Residual residual(const System<D>& s) {
  Residual out;
  const auto& p = s.particles;
  double worst = -1.0;
  for (Slot i = 0; i < p.size(); ++i) {
    const double f2 = net_force2(p, static_cast<std::size_t>(i));
    if (!exceeds(f2, worst)) continue;
    worst = f2;
    out.worst_body = i;
  }
  out.worst_force = std::sqrt(std::max(worst, 0.0));
  for (const ContactRecord<D>& c : contact_records(s)) {
    out.max_overlap = larger_or_nan(out.max_overlap, c.overlap / smaller_radius(s, c));
    out.mean_contact += std::abs(c.normal_force);
    ++out.contacts;
  }
  if (out.contacts > 0) out.mean_contact /= static_cast<double>(out.contacts);
  return out;
}

template Residual residual<2>(const System<2>&);
template Residual residual<3>(const System<3>&);
template double worst_net_force<2>(const Particles<2>&);
template double worst_net_force<3>(const Particles<3>&);
template double worst_net_force<2>(const Particles<2>&, double);
template double worst_net_force<3>(const Particles<3>&, double);
template double ForceScale::of<2>(double) const;
template double ForceScale::of<3>(double) const;
template double worst_net_force<2>(const Particles<2>&, const ForceScale&, double);
template double worst_net_force<3>(const Particles<3>&, const ForceScale&, double);

}  // namespace softgrain
