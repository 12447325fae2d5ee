// The compressible packing model: how densely grains of many sizes pack (de Larrard 1999, "Concrete Mixture
// Proportioning", E & FN Spon, ISBN 0-419-23500-0, ch. 1; de Larrard and Sedran 1994,
// doi:10.1016/0008-8846(94)90022-1). A model of others, to stand beside packings of ours.
#pragma once

#include <vector>

#include "common/packing/grading.h"

namespace softgrain {

/// Grains of one size in a mixture.
struct PackingClass {
  double diameter = 1.0;          ///< any unit of length, the same for all classes
  double share = 0.0;             ///< share of the solid volume of all classes
  double virtual_fraction = 0.0;  ///< beta: solid fraction of this class alone, placed one by one (0 < beta < 1)
};

/// Compaction index K of de Larrard (1999, table 1.3) for dry packings: simple pouring; vibration with 10 kPa on top.
inline constexpr double kPouringIndex = 4.1;
inline constexpr double kVibratedPressedIndex = 9.0;

/// Loosening of coarse grains of diameter `coarse` by finer ones: a = sqrt(1 - (1 - d_fine/d_coarse)^1.02). 0 for
/// infinitely fine grains, 1 for equal ones.
double loosening_effect(double coarse, double fine);

/// Wall effect of coarse grains on finer ones: b = 1 - (1 - d_fine/d_coarse)^1.50. 0 for infinitely fine grains, 1 for
/// equal ones.
double wall_effect(double coarse, double fine);

/// gamma_i, virtual solid fraction of the mixture if class i is the dominant one, of every class:
///   gamma_i = beta_i/(1 - sum_{j coarser} (1 - beta_i + b_ij beta_i (1 - 1/beta_j)) y_j
///                       - sum_{j finer} (1 - a_ij beta_i/beta_j) y_j),
/// y_j the volume shares. `classes`: in any order; shares need not add up to 1. Infinite where class i cannot dominate.
/// Throws InputError for no class, a diameter or share that is not positive, beta outside (0, 1).
std::vector<double> virtual_fractions(const std::vector<PackingClass>& classes);

/// Solid fraction Phi of the mixture for a compaction index K, the root of
///   K = sum_i (y_i/beta_i)/(1/Phi - 1/gamma_i)
/// below all gamma_i. One class: Phi = beta/(1 + 1/K). Throws InputError as virtual_fractions(), and for K <= 0.
double compressible_packing(const std::vector<PackingClass>& classes, double index);

/// beta of a class that alone packs to `fraction` with this compaction index: fraction (1 + 1/K).
double virtual_fraction_of(double fraction, double index);

/// Classes of a size distribution of spheres, ten to a decade of diameters as sieves of the Renard series R10, with one
/// beta for all; each at the geometric mean of its ends.
std::vector<PackingClass> packing_classes(const Grading& sizes, double virtual_fraction);

}  // namespace softgrain
