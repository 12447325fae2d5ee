// Fines alone as the cell law sees them: cells that hold nothing but fines, strained as measured samples were.
#pragma once

#include <cstdint>
#include <vector>

#include "common/data/cell_card.h"
#include "common/data/macro_result.h"
#include "macrosim/macro_packing.h"

namespace softgrain {

struct FaceFriction;
struct FaceFrictionTrial;

/// Equation of state of the fines, and the pressure at which tests of them begin; dimensionless.
struct FinesState {
  StateForm form = StateForm::porosity;
  double modulus = 0.0;         ///< K
  double exponent = 0.0;        ///< n
  double void_ratio = 0.0;      ///< e_J
  double start_pressure = 0.0;  ///< p/E
};

/// What of a test is compared.
enum class FinesMeasure {
  lateral_ratio,  ///< lateral over axial stress
  stress_ratio    ///< q/p
};

/// Some recorded points of a curve, from its start; the last ones are compared.
struct FinesPath {
  FinesMeasure measure = FinesMeasure::lateral_ratio;
  std::vector<std::size_t> points;  ///< numbers of the points in the curve
  std::vector<Vec3> length;         ///< lengths of the axes there, over those at the start
  std::size_t compared = 0;
};

/// All points before the last stage, and about eight of it, which are compared: larger strain steps change nothing.
FinesPath path_of(const MacroCurve& curve, FinesMeasure measure);

/// The measure of a curve at the compared points of the path; not a number where next to nothing bears.
std::vector<double> measured_on(const MacroCurve& curve, const FinesPath& path);

/// Sites for cells: bodies of nearly one size, packed without friction in a periodic cell. Throws UnusableResult,
/// InputError.
MacroPacking pack_sites(std::int64_t count, std::uint64_t seed);

/// The measure at the compared points, all cells at the start pressure at first. Empty where the law gives none (a cell
/// without pores, a relaxation that does not end).
std::vector<double> strain_fines(const MacroPacking& sites, const FinesState& state, const FaceFriction& friction,
                                 const FinesPath& path);

/// Rows of all paths one after another, for each trial; trials and paths side by side.
std::vector<std::vector<double>> strain_fines(const MacroPacking& sites, const FinesState& state,
                                              const std::vector<FaceFrictionTrial>& trials,
                                              const std::vector<FinesPath>& paths);

/// About how long a fit with so many cells takes [s of one core].
double friction_seconds(std::int64_t cells);

}  // namespace softgrain
