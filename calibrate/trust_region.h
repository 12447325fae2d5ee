// The one place that talks to Ceres: derivatives by differences, and a trust-region run from one start with
// one strategy.
#pragma once

#include <string>
#include <vector>

#include "calibrate/least_squares.h"

namespace softgrain {

/// dr/dp: the problem's own, or Ceres's central differences with steps of 6e-6 of each parameter (1.5e-8 of one that is
/// zero): eight to ten digits. False where r is undefined.
bool jacobian_at(const LeastSquaresProblem& problem, std::span<const double> p, std::span<double> jacobian);

/// How steps are chosen. All act on parameters divided by their size, so that units do not matter.
struct TrustRegionStrategy {
  std::string name;
  bool dogleg = false;            ///< else Levenberg-Marquardt
  bool subspace = false;          ///< dogleg over the plane of both directions, not the path alone
  bool non_monotonic = false;     ///< S may rise for a few steps
  double initial_radius = 1.0e4;  ///< initial radius in units of the scaled parameters
};

/// The strategies in the order in which they are tried.
const std::vector<TrustRegionStrategy>& trust_region_strategies();

struct TrustRegionEnd {
  bool ran = false;  ///< false: the model could not be evaluated at the start
  bool capped = false;
  int iterations = 0;
  std::vector<double> parameters;
  std::string message;
};

TrustRegionEnd run_trust_region(const LeastSquaresProblem& problem, const std::vector<double>& start,
                                const TrustRegionStrategy& strategy, const LeastSquaresOptions& options);

}  // namespace softgrain
