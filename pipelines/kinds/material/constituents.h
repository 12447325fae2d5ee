// [[constituent]] of materials and recipes: what is mixed, and what its grains are made of.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/io/scene.h"
#include "common/packing/grading.h"
#include "macrosim/macro_spec.h"

namespace softgrain {

/// One [[constituent]]: powder, sand, gravel.
struct Constituent {
  std::string name;
  double mass_share = 0.0;    ///< share of the mass of all constituents
  double density = 0.0;       ///< density of its grains [kg/m^3]
  double volume_share = 0.0;  ///< share of the solid volume of all constituents
  std::optional<Grading> sizes;
  double youngs_modulus = 0.0;  ///< E of its grains [Pa]
  double poisson_ratio = 0.0;   ///< nu
  double friction = 0.0;        ///< mu against its like
  std::int32_t material = 0;    ///< place in MacroSpec::grain_materials; 0 where all are alike
};

/// All [[constituent]]; empty without any. `common`: E, nu, mu and density of those that do not give their own.
std::vector<Constituent> read_constituents(const SceneTable& root, const MacroSpec& common);

/// Refuses what [material] says where every constituent gives its own.
void refuse_idle_material(const SceneTable& root);

/// Gives the spec what the grains are made of. Where all constituents have one E, nu and mu, the spec has these and
/// everything is as without constituents; else each has its material, and 1/E, nu and density of the spec are the means
/// over the solid volume, and mu is the largest. Refuses more materials than a system has room for.
void take_materials(const SceneTable& root, std::vector<Constituent>& constituents, MacroSpec& spec);

/// Mean density over the solid volume [kg/m^3].
double mean_density(const std::vector<Constituent>& constituents);

/// Sizes of all constituents together, by solid volume.
Grading mixed_sizes(const std::vector<Constituent>& constituents);

/// What grains of several materials are made of, and what E is of which stresses are said to be so much: `whole` for
/// all of them together [Pa]. Empty where grains are alike.
std::string materials_text(const GrainMaterials& materials, double whole);

}  // namespace softgrain
