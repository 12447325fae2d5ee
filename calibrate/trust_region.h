// The parts of a least-squares fit: derivatives by differences and a trust-region run from one start with one strategy
// (the one place that talks to Ceres), and the linear algebra of an end point: rank, covariance, the Gauss-Newton step
// that is left, the polish.
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

/// The problem linearised at one point. Parameters at an active bound are left out.
struct Linearisation {
  bool defined = false;
  double residual_sum_of_squares = 0.0;
  std::vector<bool> at_bound;  ///< whether the parameter is on a bound, with S falling outwards
  int rank = 0;
  bool rank_deficient = false;
  std::vector<double> step;        ///< Gauss-Newton step -(J^T J)^+ J^T r, zero for parameters at a bound
  std::vector<double> inverse;     ///< (J^T J)^-1, n x n row-major; rows of parameters at a bound are zero
  std::vector<bool> undetermined;  ///< the parameter has a part in a direction that the data do not see
};

Linearisation linearise(const LeastSquaresProblem& problem, const std::vector<double>& p, double rank_tolerance);

/// The same with residuals and slopes that are known: finite numbers.
Linearisation linearised(const LeastSquaresProblem& problem, const std::vector<double>& p,
                         const std::vector<double>& residuals, const std::vector<double>& jacobian,
                         double rank_tolerance);

/// Full Gauss-Newton steps while they shrink or S falls (and S does not grow beyond rounding): the last digits that a
/// trust region leaves.
void polish(const LeastSquaresProblem& problem, std::vector<double>& p, double rank_tolerance);

/// Largest |step_j| in standard deviations; components below 1e-10 of the parameter's size count as nothing.
double step_in_deviations(const Linearisation& at, const std::vector<double>& p, std::size_t residuals);

}  // namespace softgrain
