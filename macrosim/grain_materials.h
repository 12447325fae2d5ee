// Solid grains of several materials: which material a grain has in a system, and the contact law of every pair.
#pragma once

#include <cstdint>
#include <vector>

#include "common/contact/law_set.h"
#include "common/core/material.h"
#include "common/packing/grading.h"
#include "macrosim/macro_spec.h"

namespace softgrain {

/// Friction of contacts between grains of these two of MacroSpec::grain_materials: pair_friction(); MacroSpec::friction
/// where all grains are alike.
double friction_between(const MacroSpec& spec, std::int32_t m1, std::int32_t m2);

/// Number of materials of the solid grains, 1 where all are alike.
std::int32_t count_of_materials(const MacroSpec& spec);

/// Elasticity and density of this material of the solid grains; `name` is that of the only one.
Material solid_material(const MacroSpec& spec, std::int32_t material, const char* name);

/// Density of the grains of this material [kg/m^3].
double grain_density(const MacroSpec& spec, std::int32_t material);

/// The softest and the densest material: bounds of overlaps and of time steps.
double lowest_modulus(const MacroSpec& spec);
double highest_density(const MacroSpec& spec);

/// Friction and restitution of the contacts of solid grains.
struct SolidContacts {
  double friction = 0.0;  ///< no contact between grains has more
  double wall_friction = 0.0;
  double restitution = 1.0;
  RollingResistance rolling{};
};

/// Hertz-Mindlin laws of all pairs of solid grains and of each with walls, which have the material of the spec:
/// `number[m]` is the material of grains m in the system, `wall` that of the walls. Effective moduli are those of the
/// pair, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 and 1/G* = (2 - nu1)/G1 + (2 - nu2)/G2, and so is the damping.
void set_solid_laws(const MacroSpec& spec, const std::vector<std::int32_t>& number, std::int32_t wall,
                    const SolidContacts& contacts, LawSet& laws);

/// Makes E and density of the spec those of packings of these sizes: 1/E is the mean of 1/E over the solid volume
/// (contacts in a row, the same as the mean of 1/E over pairs drawn at random), density the mean. With grains of one
/// size the pressure over this E differs from that of one material by at most 6 % at a ratio of E of 3, and 23 % at 10;
/// over the arithmetic mean by 25 % and 60 %. Does nothing where all grains are alike.
void take_reference(MacroSpec& spec, const Grading& sizes);

}  // namespace softgrain
