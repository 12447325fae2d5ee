// [[stage]] of macro scenes: a test in parts.
#pragma once

#include <array>

#include "common/io/scene.h"
#include "macrosim/macro_spec.h"

namespace softgrain {

/// Reads the tables `stage` of `holder`; where there are any they are the test, in place of what `spec` had, and
/// `macro`, the table that says everything else of the scene, must not name one. Steps, increments and tolerance of a
/// stage are those of `spec` unless it says them. Throws BadInput.
void read_stages(const SceneTable& holder, const SceneTable& macro, MacroSpec& spec);

/// Key `modulus_stress`: the two stresses [Pa] between which moduli are taken; as they were where the table has none.
void read_modulus_stress(const SceneTable& t, std::array<double, 2>& interval);

/// What a test does to the box, roughly, were all bodies to move with it: for estimates before a run.
struct RoughStrains {
  double largest_axial = 0.0;       ///< shortening of z at its most
  double largest_volumetric = 0.0;  ///< loss of volume at its most
  double way = 0.0;                 ///< all strains of all axes, whatever their sign, largest axis of each stage
};
RoughStrains rough_strains(const MacroSpec& spec);

}  // namespace softgrain
