// Minima of sums of squares on kinks of the residuals: where dS/dp jumps, no Gauss-Newton step vanishes, and a
// trust region ends short of the minimum.
#pragma once

#include <optional>
#include <vector>

#include "calibrate/least_squares.h"
#include "calibrate/trust_region.h"

namespace softgrain {

struct KinkMinimum {
  std::vector<double> parameters;
  std::size_t kinks = 0;  ///< number of kinks that it lies on
  /// The problem linearised with the slopes between those of both sides of each kink for which the step vanishes. S
  /// rises faster than with these slopes, because it has a corner: their covariance is an upper bound, also across the
  /// kinks.
  Linearisation at;
};

/// Searches downhill from `from` with Gauss-Newton steps along the kinks (LeastSquaresProblem::kinks), and leaves a
/// kink where S falls on one of its sides; so it may end between kinks, too. Nothing where S does not rise to both
/// sides of every kink at the end with the other parameters fitted again, or where the data do not determine a step.
///
/// With residuals r_0 + sum_k h_k max(0, g_k), the minimum on g_k = 0 has a J = J_0 + sum_k l_k h_k (grad g_k)^T with
/// J^T r = 0, r^T h_k > 0 and 0 <= l_k <= 1: zero is in Clarke's generalised gradient (F. H. Clarke, Optimization and
/// Nonsmooth Analysis, Wiley 1983, doi 10.1137/1.9781611971309).
std::optional<KinkMinimum> find_kink_minimum(const LeastSquaresProblem& problem, const std::vector<double>& from,
                                             double rank_tolerance);

}  // namespace softgrain
