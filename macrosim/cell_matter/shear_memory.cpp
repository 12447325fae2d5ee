#include "macrosim/cell_matter/shear_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/data/cell_card.h"

namespace softgrain {

namespace {

double onset_of(double solid, double pores) { return solid / (solid + pores); }

/// Slope of the backbone in each piece; a spring takes with it the difference to the next piece.
Backbone make_backbone() {
  constexpr std::array<double, kFaceSprings> kEnds{0.1, 0.3, 0.7, 1.5, 3.5, 9.0};
  std::array<double, kFaceSprings + 1> slope{};
  double before = 0.0;
  double reached = 0.0;
  for (std::size_t s = 0; s < kFaceSprings; ++s) {
    const double tau = kEnds[s] / std::hypot(1.0, kEnds[s]);
    slope[s] = (tau - reached) / (kEnds[s] - before);
    before = kEnds[s];
    reached = tau;
  }
  slope[0] = 1.0;
  Backbone out;
  double limit = 0.0;
  for (std::size_t s = 0; s < kFaceSprings; ++s) {
    out.share[s] = slope[s] - slope[s + 1];
    limit += out.share[s] * kEnds[s];
  }
  for (std::size_t s = 0; s < kFaceSprings; ++s) out.yield[s] = kEnds[s] / limit;
  return out;
}

Vec3 in_plane(const Vec3& v, const Vec3& normal) { return v - normal * dot(v, normal); }

}  // namespace

int memory_parts(double largest_strain) {
  constexpr double kRounding = 1e-9;
  return std::max(1, static_cast<int>(std::ceil(largest_strain / kMemoryStrain * (1.0 - kRounding))));
}

const Backbone& backbone() {
  static const Backbone made = make_backbone();
  return made;
}

double ShearMemory::strength(double mu_f, const CellContent& content, double volume) const {
  if (!(strength_slope > 0.0)) return mu_f;
  const double phi = content.solid / volume;
  const double onset = onset_of(content.solid, content.pores);
  const double critical = onset_of(content.solid, content.critical);
  const double psi = (critical + density_slope * std::max(phi - onset, 0.0) - onset) / (1.0 - critical);
  const double mu = mu_f * (1.0 + strength_range * std::tanh(-strength_slope * psi / strength_range));
  if (!(least_state > 0.0) || mu >= mu_f) return mu;
  const double x = (phi - onset) / (1.0 - onset);
  return mu_f + (mu - mu_f) * std::clamp(0.5 * (x / least_state - 1.0), 0.0, 1.0);
}

double ShearMemory::pores_after(double mu_f, const CellContent& content, double volume, double slip,
                                double used) const {
  if (!(dilatancy > 0.0)) return content.pores;
  const double onset = onset_of(content.solid, content.pores);
  const double critical_ratio = 1.5 * mu_f;
  double moved = onset * (1.0 + dilatancy * (critical_ratio * slip - used));
  if (moved > onset && least_state > 0.0) {
    const double phi = content.solid / volume;
    moved = std::min(moved, std::max(onset, (phi - least_state) / (1.0 - least_state)));
  }
  return content.solid * (1.0 - moved) / moved;
}

PulledSprings pull(const SpringForces& before, double k0, double k, const Vec3& motion, const Vec3& normal,
                   double limit) {
  PulledSprings out;
  if (!(k > 0.0)) return out;
  const Backbone& b = backbone();
  const double ratio = k0 > 0.0 ? k / k0 : 0.0;
  const Vec3 moved = in_plane(motion, normal) * k;
  std::size_t at_limit = 0;
  double yielding = 0.0;
  for (std::size_t s = 0; s < kFaceSprings; ++s) {
    Vec3& force = out.force[s];
    force = in_plane(before[s], normal) * ratio - moved * b.share[s];
    const double most = b.share[s] * b.yield[s] * limit;
    const double size = norm(force);
    double left = 1.0;
    if (size > most) {
      left = most / size;
      force *= left;
      ++at_limit;
      yielding += b.share[s] * left;
    }
    out.kept += b.share[s] * left;
    out.sum += force;
    out.energy += norm2(force) / (2.0 * b.share[s] * k);
  }
  out.slides = at_limit == kFaceSprings;
  out.yields = out.kept > 0.0 ? yielding / out.kept : 0.0;
  return out;
}

FaceSlip slip_of(const Vec3& force_before, double k0, const Vec3& force, double k, const Vec3& motion,
                 const Vec3& normal) {
  if (!(k > 0.0)) return {};
  const Vec3 held = k0 > 0.0 ? in_plane(force_before, normal) * (k / k0) : Vec3{};
  // T acts against the motion, so the slip goes against it too.
  const Vec3 slip = in_plane(motion, normal) * -1.0 - (force - held) * (1.0 / k);
  return {norm(slip), std::max(0.0, 0.5 * dot(force + held, slip))};
}

void require_valid(const ShearMemory& m) {
  const auto refuse = [](const std::string& why) { throw InputError("shear memory: " + why); };
  if (!(m.dilatancy >= 0.0 && m.strength_slope >= 0.0 && m.least_state >= 0.0) || !std::isfinite(m.dilatancy) ||
      !std::isfinite(m.strength_slope) || !std::isfinite(m.density_slope))
    refuse(fmt::format("A = {}, m = {}, x_r = {}; all must be numbers from 0 on", m.dilatancy, m.strength_slope,
                       m.least_state));
  if (!(m.least_state < 1.0)) refuse(fmt::format("x_r = {}; it must be below 1", m.least_state));
  if (!(m.critical_pores > 0.0) || !std::isfinite(m.critical_pores))
    refuse(fmt::format("r_c = {}; it must be above 0", m.critical_pores));
  if (!(m.strength_range > 0.0 && m.strength_range < 1.0))
    refuse(fmt::format("c = {}; it must be within (0, 1)", m.strength_range));
  if (m.dilatancy > most_dilatancy(m.strength_range))
    refuse(
        fmt::format("A = {} with c = {}: slip of the strongest faces would give energy back; A may be at most "
                    "(1 + c)/c = {:.4g}",
                    m.dilatancy, m.strength_range, most_dilatancy(m.strength_range)));
}

}  // namespace softgrain
