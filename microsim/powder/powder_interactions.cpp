#include "microsim/powder/powder_interactions.h"

#include <cmath>

#include "common/dynamics/force_pass.h"

namespace softgrain {

namespace {

ForceKind kind_of(const PowderInteraction& pair, double zero) {
  if (pair.distant) return ForceKind::distant;
  if (pair.force() < zero) return ForceKind::unstressed;
  return pair.normal_force > 0.0 ? ForceKind::compressive : ForceKind::tensile;
}

}  // namespace

double PowderInteraction::force() const { return std::hypot(normal_force, tangential_force); }

std::vector<PowderInteraction> powder_interactions(const System<2>& system, double zero) {
  std::vector<PowderInteraction> out;
  for (const ContactRecord<2>& c : contact_records(system)) {
    PowderInteraction pair;
    pair.i = c.i;
    pair.j = c.j;
    pair.normal = c.normal;
    pair.branch = c.branch;
    pair.arm_i = system.particles.sphere[static_cast<std::size_t>(c.i)].r - 0.5 * c.overlap;
    pair.arm_j = system.particles.sphere[static_cast<std::size_t>(c.j)].r - 0.5 * c.overlap;
    pair.normal_force = c.normal_force;
    pair.tangential_force = dot(c.tangential_force, Vec<2>{{-c.normal[1], c.normal[0]}});
    pair.rolling_moment = c.rolling_moment[0];
    pair.distant = c.overlap <= 0.0;
    pair.kind = kind_of(pair, zero);
    out.push_back(pair);
  }
  return out;
}

Vec<2> winding(const System<2>& system, const PowderInteraction& pair) {
  const auto& disks = system.particles.sphere;
  const Vec<2> shift =
      disks[static_cast<std::size_t>(pair.i)].x - disks[static_cast<std::size_t>(pair.j)].x - pair.branch;
  Vec<2> steps{};
  for (int k = 0; k < 2; ++k)
    if (system.cell.periodic[static_cast<std::size_t>(k)]) steps[k] = std::round(shift[k] / system.cell.edges[k][k]);
  return steps;
}

}  // namespace softgrain
