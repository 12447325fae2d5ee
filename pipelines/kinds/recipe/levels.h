// Levels of a size distribution: slices that follow each other, from the coarsest to the finest.
#pragma once

#include <vector>

#include "common/packing/grading.h"

namespace softgrain {

struct RecipeLevel {
  double low = 0.0;    ///< smallest radius in it [m]
  double high = 0.0;   ///< largest
  double share = 0.0;  ///< share of the solid volume of all levels
  std::vector<SizePiece> pieces;
};

/// Cuts [m], descending, that split the sizes into the least number of slices of equal ratio, none above `ratio`.
/// Slices without a grain, or with less than `least_share` of the volume, are joined with their neighbour.
std::vector<double> find_cuts(const Grading& sizes, double ratio, double least_share);

/// The slices between the cuts (radii, descending), those without a grain left out.
std::vector<RecipeLevel> levels_of(const Grading& sizes, const std::vector<double>& cuts);

/// The grains of a level alone, and of a level with the next finer one, of which the fines have this share of the
/// volume; the largest radius is 1 cm, since nothing that is measured depends on the scale: slices of equal shape are
/// equal, wherever on the curve they are.
Grading slice_of(const RecipeLevel& level);
Grading pair_of(const RecipeLevel& coarse, const RecipeLevel& fine, double fines_share);
/// The largest radius of fines over that of the coarse level, in the units of pair_of().
double cut_of_pair(const RecipeLevel& coarse, const RecipeLevel& fine);

/// All levels from `first` on together, as they are in the whole.
Grading joined(const std::vector<RecipeLevel>& levels, std::size_t first, std::size_t count);

/// Mean solid volume of a grain [m^3].
double mean_grain_volume(const std::vector<SizePiece>& pieces);

}  // namespace softgrain
