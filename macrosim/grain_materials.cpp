#include "macrosim/grain_materials.h"

#include <algorithm>
#include <cstddef>

namespace softgrain {

namespace {

const GrainMaterial& material_of(const MacroSpec& spec, std::int32_t material) {
  return spec.grain_materials.each.at(static_cast<std::size_t>(material));
}

}  // namespace

double friction_between(const MacroSpec& spec, std::int32_t m1, std::int32_t m2) {
  if (spec.grain_materials.empty()) return spec.friction;
  return pair_friction(material_of(spec, m1).friction, material_of(spec, m2).friction);
}

std::int32_t count_of_materials(const MacroSpec& spec) {
  return std::max<std::int32_t>(1, static_cast<std::int32_t>(spec.grain_materials.each.size()));
}

Material solid_material(const MacroSpec& spec, std::int32_t material, const char* name) {
  if (spec.grain_materials.empty()) return {name, spec.density, spec.youngs_modulus, spec.poisson_ratio, false};
  const GrainMaterial& m = material_of(spec, material);
  return {m.name, m.density, m.youngs_modulus, m.poisson_ratio, false};
}

double grain_density(const MacroSpec& spec, std::int32_t material) {
  return spec.grain_materials.empty() ? spec.density : material_of(spec, material).density;
}

double lowest_modulus(const MacroSpec& spec) {
  double lowest = spec.youngs_modulus;
  for (const GrainMaterial& m : spec.grain_materials.each) lowest = std::min(lowest, m.youngs_modulus);
  return lowest;
}

double highest_density(const MacroSpec& spec) {
  double highest = spec.density;
  for (const GrainMaterial& m : spec.grain_materials.each) highest = std::max(highest, m.density);
  return highest;
}

void set_solid_laws(const MacroSpec& spec, const std::vector<std::int32_t>& number, std::int32_t wall,
                    const SolidContacts& contacts, LawSet& laws) {
  const auto law = [&](const Material& a, const Material& b, double friction) {
    return hertz_law(HertzCoefficients::of(a, b, friction, contacts.restitution, contacts.rolling), false);
  };
  const Material of_wall{"wall", spec.density, spec.youngs_modulus, spec.poisson_ratio, false};
  for (std::int32_t a = 0; a < count_of_materials(spec); ++a) {
    const Material of_a = solid_material(spec, a, "grain");
    const std::int32_t at_a = number[static_cast<std::size_t>(a)];
    for (std::int32_t b = a; b < count_of_materials(spec); ++b) {
      const double friction =
          spec.grain_materials.empty() ? contacts.friction : std::min(contacts.friction, friction_between(spec, a, b));
      laws.set(at_a, number[static_cast<std::size_t>(b)], law(of_a, solid_material(spec, b, "grain"), friction));
    }
    laws.set(at_a, wall, law(of_a, of_wall, contacts.wall_friction));
  }
}

void take_reference(MacroSpec& spec, const Grading& sizes) {
  if (spec.grain_materials.empty()) return;
  double volume = 0.0;
  double compliance = 0.0;
  double density = 0.0;
  for (const SizePiece& p : sizes.pieces()) {
    const GrainMaterial& m = material_of(spec, p.material);
    volume += p.volume;
    compliance += p.volume / m.youngs_modulus;
    density += p.volume * m.density;
  }
  spec.youngs_modulus = volume / compliance;
  spec.density = density / volume;
}

}  // namespace softgrain
