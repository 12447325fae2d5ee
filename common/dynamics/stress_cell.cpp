#include "common/dynamics/stress_cell.h"

#include <algorithm>
#include <cmath>

#include "common/dynamics/pair_loop.h"
#include "common/dynamics/scatter_sink.h"
#include "common/neighbours/verlet_list.h"

namespace softgrain {

namespace {

/// To the bodies, and the sum over pairs of force times branch, per axis.
template <int D>
struct VirialSink {
  ScatterSink<D> scatter;
  Vec<D>& virial;

  void apart(std::size_t) {}
  template <bool kTorque>
  void touch(std::size_t c, std::size_t i, std::size_t j, const ContactGeometry<D>& g, const ContactResponse<D>& r) {
    scatter.template touch<kTorque>(c, i, j, g, r);
    for (int k = 0; k < D; ++k) virial[k] += (g.normal[k] * r.normal_force + r.tangential_force[k]) * g.branch[k];
  }
  void roll(std::size_t i, std::size_t j, const Rot<D>& moment) { scatter.roll(i, j, moment); }
};

template <int D>
Vec<D> lengths(const Cell<D>& cell) {
  Vec<D> out;
  for (int k = 0; k < D; ++k) out[k] = cell.edges[k][k];
  return out;
}

}  // namespace

template <int D>
Vec<D> StressCellVerlet<D>::peculiar(const System<D>& s, std::size_t u) const {
  Vec<D> v = s.particles.velocity[u];
  for (int k = 0; k < D; ++k) v[k] -= s.cell.velocity_gradient[k][k] * s.particles.sphere[u].x[k];
  return v;
}

template <int D>
void StressCellVerlet<D>::sum_forces(System<D>& s, double dt, History history) {
  auto& p = s.particles;
  update_neighbours(s);
  std::fill(p.force.begin(), p.force.end(), Stored<D>{});
  std::fill(p.torque.begin(), p.torque.end(), StoredRot<D>{});
  virial_ = {};
  VirialSink<D> sink{{p}, virial_};
  pair_loop(s, dt, sink, history);
  ++s.cost.loop_passes;
  s.cost.contact_evaluations += s.contacts.size();
}

/// Stress of the state, and the cell's own acceleration for a time.
template <int D>
void StressCellVerlet<D>::drive(System<D>& s, double time) {
  Vec<D> sum = virial_;
  for (Slot i = 0; i < s.particles.grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    const Vec<D> v = peculiar(s, u);
    for (int k = 0; k < D; ++k) sum[k] += v[k] * v[k] / s.particles.inverse_mass[u];
  }
  const double area = s.cell.volume();
  for (int k = 0; k < D; ++k) {
    stress_[k] = sum[k] / area;
    if (std::isinf(control_.cell_mass)) continue;
    const double l0 = control_.reference_length[k];
    rate_[k] -= time * l0 * (control_.imposed[k] - stress_[k]) / control_.cell_mass;
    rate_[k] = std::clamp(rate_[k], -control_.strain_rate_cap * l0, control_.strain_rate_cap * l0);
  }
}

template <int D>
void StressCellVerlet<D>::initialise(System<D>& s) {
  for (int k = 0; k < D; ++k) rate_[k] = s.cell.velocity_gradient[k][k] * s.cell.edges[k][k];
  sum_forces(s, 0.0, History::none);
  drive(s, 0.0);
}

template <int D>
void StressCellVerlet<D>::step(System<D>& s) {
  auto& p = s.particles;
  const double half = 0.5 * dt_;
  const std::size_t bodies = p.sphere.size();
  middle_.resize(bodies);
  middle_spin_.resize(bodies);
  for (std::size_t u = 0; u < bodies; ++u) {
    Vec<D> v = peculiar(s, u);
    for (int k = 0; k < D; ++k)
      v[k] += half * (p.force[u][k] * p.inverse_mass[u] + s.cell.velocity_gradient[k][k] * v[k]);
    middle_[u] = v;
    middle_spin_[u] = static_cast<Rot<D>>(p.spin[u]) + static_cast<Rot<D>>(p.torque[u]) * (half * p.inverse_inertia[u]);
  }
  drive(s, half);
  const Vec<D> before = lengths(s.cell);
  for (int k = 0; k < D; ++k) s.cell.edges[k][k] += dt_ * rate_[k];
  const Vec<D> after = lengths(s.cell);
  for (int k = 0; k < D; ++k) s.cell.velocity_gradient[k][k] = rate_[k] / after[k];
  for (std::size_t u = 0; u < bodies; ++u) {
    for (int k = 0; k < D; ++k) {
      const double between = 0.5 * (before[k] + after[k]);
      p.sphere[u].x[k] = after[k] * (p.sphere[u].x[k] / before[k] + dt_ * middle_[u][k] / between);
      const double predicted = middle_[u][k] + half * p.force[u][k] * p.inverse_mass[u];
      p.velocity[u][k] = predicted + s.cell.velocity_gradient[k][k] * p.sphere[u].x[k];
    }
    p.spin[u] = middle_spin_[u] + static_cast<Rot<D>>(p.torque[u]) * (half * p.inverse_inertia[u]);
  }
  sum_forces(s, dt_, History::advance);
  for (std::size_t u = 0; u < bodies; ++u) {
    // A rebuild may have carried the body to another image; its velocity went along, the peculiar one stayed.
    for (int k = 0; k < D; ++k) {
      const double kappa = s.cell.velocity_gradient[k][k];
      const double v = middle_[u][k] + half * (p.force[u][k] * p.inverse_mass[u] + kappa * middle_[u][k]);
      p.velocity[u][k] = v + kappa * p.sphere[u].x[k];
    }
    p.spin[u] = middle_spin_[u] + static_cast<Rot<D>>(p.torque[u]) * (half * p.inverse_inertia[u]);
  }
  drive(s, half);
  // The velocities of bodies follow the corrected motion of the cell.
  for (std::size_t u = 0; u < bodies; ++u)
    for (int k = 0; k < D; ++k)
      p.velocity[u][k] += (rate_[k] / after[k] - s.cell.velocity_gradient[k][k]) * p.sphere[u].x[k];
  for (int k = 0; k < D; ++k) s.cell.velocity_gradient[k][k] = rate_[k] / after[k];
  s.time += dt_;
  ++s.step;
}

template <int D>
PowderResidual<D> powder_residual(const System<D>& s, const Vec<D>& imposed, const Vec<D>& measured, double f1,
                                  double largest_diameter, bool lengths_free) {
  PowderResidual<D> out;
  const auto& p = s.particles;
  double kinetic = 0.0;
  for (Slot i = 0; i < p.grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    out.force = std::max(out.force, norm(static_cast<Vec<D>>(p.force[u])));
    out.moment = std::max(out.moment, std::sqrt(norm2(static_cast<Rot<D>>(p.torque[u]))));
    // Nothing slows a disk in free flight, nor its spin: it is a rattler, and the pack may rest without it.
    if (static_cast<Vec<D>>(p.force[u]) == Vec<D>{} && static_cast<Rot<D>>(p.torque[u]) == Rot<D>{}) continue;
    Vec<D> v = p.velocity[u];
    for (int k = 0; k < D; ++k) v[k] -= s.cell.velocity_gradient[k][k] * p.sphere[u].x[k];
    kinetic += 0.5 * norm2(v) / p.inverse_mass[u] + 0.5 * norm2(static_cast<Rot<D>>(p.spin[u])) / p.inverse_inertia[u];
  }
  constexpr double kForce = 1e-4;
  constexpr double kKinetic = 5e-8;
  out.force /= kForce * f1;
  out.moment /= kForce * f1 * largest_diameter;
  out.kinetic = kinetic / static_cast<double>(std::max<Slot>(p.grains, 1)) / (kKinetic * f1 * largest_diameter);
  for (int k = 0; lengths_free && k < D; ++k)
    out.pressure = std::max(out.pressure, std::abs(imposed[k] - measured[k]) * largest_diameter / (kForce * f1));
  return out;
}

template class StressCellVerlet<2>;
template PowderResidual<2> powder_residual<2>(const System<2>&, const Vec<2>&, const Vec<2>&, double, double, bool);

}  // namespace softgrain
