// Fines alone as the cell law sees them: cells that hold nothing but fines, strained as measured samples were.
#pragma once

#include <vector>

#include "common/data/cell_card.h"
#include "common/data/macro_result.h"
#include "macrosim/cell_matter/cell_packing.h"
#include "macrosim/macro_packing.h"

namespace softgrain {

/// Equation of state of the fines, and the pressure at which tests of them begin; dimensionless.
struct FinesState {
  StateForm form = StateForm::porosity;
  double modulus = 0.0;         ///< K
  double exponent = 0.0;        ///< n
  double void_ratio = 0.0;      ///< e_J
  double start_pressure = 0.0;  ///< p/E
};

/// What is compared with measurements: of a stage, at its points.
enum class FinesMeasure {
  lateral_ratio,  ///< lateral over axial stress
  stress_ratio    ///< q/p
};

/// Lengths of the axes over those at the start, at recorded points; the measure counts from point `first` on.
struct FinesPath {
  std::vector<Vec3> length;
  std::size_t first = 1;
  FinesMeasure measure = FinesMeasure::lateral_ratio;
};

/// The way of a measured curve; the measure is that of its last stage.
FinesPath path_of(const MacroCurve& curve, FinesMeasure measure);

/// The measure of a curve at the points of its last stage.
std::vector<double> measured_on(const MacroCurve& curve, FinesMeasure measure);

/// Sites for cells: bodies of nearly one size, packed without friction in a periodic cell; no randomness but the seed.
MacroPacking pack_sites(std::int64_t count, std::uint64_t seed);

/// Stress ratios along the path, all cells at the start pressure at first; in the order of the points. Empty where the
/// law gives none (a cell without pores, a relaxation that does not end).
std::vector<double> strain_fines(const MacroPacking& sites, const FinesState& state, const FaceFriction& friction,
                                 const FinesPath& path);

}  // namespace softgrain
