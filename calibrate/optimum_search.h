// Where a noisy result is largest or smallest over one or two inputs: a quadratic response surface near the best
// points, the interval of its optimum, and where to look next (Box and Wilson 1951,
// doi:10.1111/j.2517-6161.1951.tb00067.x).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "calibrate/response_surface.h"
#include "common/core/statistics.h"

namespace softgrain {

/// The place of the unit box where a surface of one quantity is largest (or smallest), and its value there.
struct SurfaceOptimum {
  std::vector<double> u;
  double value = 0.0;
};

/// Exact: the stationary point, those of the edges and the corners. Throws InputError for other than one or two inputs
/// or more than one quantity.
SurfaceOptimum optimum_of(const ResponseSurface& surface, bool maximise);

/// Results at points of the unit box, one value per seed; all points have the same seeds.
struct SearchedPoints {
  std::vector<std::vector<double>> points;
  std::vector<std::vector<double>> values;
};

struct OptimumEstimate {
  bool usable = false;
  std::string message = "not run";
  std::vector<Estimate> u;          ///< place with 95 % interval, one per input
  Estimate value;                   ///< of the surface there
  double inside = 0.0;              ///< share of the replicates whose optimum is inside the box, not at an end of it
  bool over_seeds = false;          ///< whether the interval is from seeds, not from the scatter about the surface
  std::vector<std::size_t> fitted;  ///< points that the surface is fitted to
  std::vector<ResponseSurface> surfaces;  ///< fitted one first, then those of the replicates
  std::vector<double> residuals;          ///< of the fitted points, in their order
};

/// Least number of seeds from which an interval is taken.
inline constexpr std::size_t kLeastSearchSeeds = 3;

/// Fits the surface to the half of the points that are nearest to its optimum, but to two more than it has coefficients
/// at least (of fewer points to all), and to as many more as lie on the same surface by their scatter (predictive test
/// of Chow 1960, doi:10.2307/1910133). The interval is that of 400 bootstrap replicates: with kLeastSearchSeeds or more
/// seeds these are drawn with replacement, the same at all points, so that what packings of one seed have in common
/// cancels; with fewer, residuals about the surface are drawn, scaled by sqrt(n/(n - coefficients)). Both are widened
/// by Student's t. Not usable, with the reason: fewer points than coefficients. Deterministic in `seed`.
OptimumEstimate find_optimum(const SearchedPoints& data, bool maximise, std::uint64_t seed);

/// Points of the first round: 5 evenly spaced ones of one input, 3 x 3 of two.
std::vector<std::vector<double>> first_search_points(std::size_t inputs);

/// Points of round `round` (1, 2, ...) about the optimum: it and one step to either side along each input, the step
/// being half of that of the round before. Left out: points nearer than a quarter of a step to one that is there.
std::vector<std::vector<double>> next_search_points(const std::vector<double>& optimum,
                                                    const std::vector<std::vector<double>>& there, int round);

}  // namespace softgrain
