#include "macrosim/hard_bodies.h"

#include "common/core/particles.h"

namespace softgrain {

namespace {

Material hard_material(const MacroSpec& spec) {
  return {"hard", spec.density, spec.youngs_modulus, spec.poisson_ratio, false};
}

}  // namespace

AnyLaw HardBodies::law(const MacroSpec& spec, double friction, double restitution) {
  const Material hard = hard_material(spec);
  return hertz_law(HertzCoefficients::of(hard, hard, friction, restitution), false);
}

HardBodies::HardBodies(const MacroSpec& spec, const MacroPacking& packing, double friction, double restitution) {
  frictional_ = friction > 0.0;
  system.materials = {hard_material(spec)};
  system.laws = LawSet(1);
  system.laws.set(0, 0, law(spec, friction, restitution));
  const bool periodic = spec.boundary == Boundary::periodic;
  const Vec3 corner = periodic ? packing.low : Vec3{};
  for (const MacroBody& b : packing.bodies) {
    NewBody<3> grain;
    grain.x = b.x - corner;
    grain.r = b.r;
    grain.mass = spec.density * kSphereVolume * cube(b.r);
    if (friction > 0.0) grain.inertia = 0.4 * grain.mass * b.r * b.r;
    add_grain(system.particles, grain);
  }
  box = periodic ? add_periodic_cell(system, packing.size()) : add_box(system, packing.low, packing.high, 0);
}

double HardBodies::pressure() {
  const Vec3 edge = size();
  const Vec3 stress =
      box.periodic ? virial_.of(system) * (1.0 / (edge[0] * edge[1] * edge[2])) : box_stress(system, box);
  return (stress[0] + stress[1] + stress[2]) / 3.0;
}

double HardBodies::fraction() const {
  double volume = 0.0;
  for (std::size_t u = 0; u < at(system.particles.grains); ++u)
    volume += kSphereVolume * cube(system.particles.sphere[u].r);
  const Vec3 edge = size();
  return volume / (edge[0] * edge[1] * edge[2]);
}

std::vector<BodySpring> HardBodies::springs() const {
  std::vector<BodySpring> out;
  const auto& list = system.contacts;
  if (!frictional_ || !list.has_spring) return out;
  for (const ContactSection& section : list.sections) {
    if (section.geometry != Geometry::sphere_sphere) continue;
    for (auto c = at(section.begin); c < at(section.end); ++c)
      if (list.spring[c] != Stored<3>{}) out.push_back({list.i[c], list.j[c], list.spring[c]});
  }
  return out;
}

void HardBodies::take_over(MacroPacking& packing) const {
  packing.low = box_low(system, box);
  packing.high = box_high(system, box);
  for (std::size_t k = 0; k < packing.bodies.size(); ++k) packing.bodies[k].x = system.particles.sphere[k].x;
  packing.springs = springs();
  packing.cost += {system.cost.loop_passes, system.cost.contact_evaluations, watch_.seconds()};
}

}  // namespace softgrain
