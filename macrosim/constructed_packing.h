// Macro scenes by construction: solid grains of the first decade, and soft particles in the voids between them
// [SP 1.1, 1.9].
#pragma once

#include <cstdint>
#include <vector>

#include "common/data/measurements.h"
#include "common/packing/grading.h"
#include "macrosim/macro_packing.h"

namespace softgrain {

/// Solid grains of power-law radii, compacted without friction to solid_fill; then the largest sphere that fits, up to
/// soft_radius_max, becomes a soft particle, again and again until they hold soft_share of the volume of all bodies;
/// then all bodies are brought just into touch. Throws InputError when the voids down to
/// soft_radius_max/soft_polydispersity do not hold that share (saying what they hold), UnusableResult when it does not
/// jam.
MacroPacking make_constructed_packing(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample,
                                      const PreparationWatch& watch = {});

/// The packing that the spec asks for: with cells their places, else by spec.construction.
MacroPacking make_packing(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample,
                          const PreparationWatch& watch = {});

/// What a scene is made of, the contents of its soft particles included.
struct SceneFacts {
  std::int64_t solid = 0;
  std::int64_t soft = 0;
  std::int64_t inner_grains = 0;
  double soft_share = 0.0;       ///< share of soft particles, by their shell, in the volume of all bodies
  double body_fraction = 0.0;    ///< volume of the bodies over that of the box
  double solid_fraction = 0.0;   ///< volume of the grains over that of the box: a soft particle counts by its content
  double soft_radius_low = 0.0;  ///< smallest radius of the soft particles [m]
  double soft_radius_mean = 0.0;
  double soft_radius_high = 0.0;
  ExponentFit exponent;  ///< power-law exponent of the radii of all grains, outer and inner, by maximum likelihood
  double largest_over_smallest = 0.0;  ///< ratio of the largest to the smallest of these radii
};

/// Soft particle k holds content k (cyclically), as in the twins. Without contents they count as solid.
SceneFacts describe(const MacroPacking& packing, const std::vector<ShellPacking>& contents);

}  // namespace softgrain
