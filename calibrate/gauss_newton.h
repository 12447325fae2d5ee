// The linear algebra of a least-squares end point: rank, covariance, the Gauss-Newton step that is left, and the
// polish.
#pragma once

#include <vector>

#include "calibrate/least_squares.h"

namespace softgrain {

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

/// Full Gauss-Newton steps while they shrink or S falls (and S does not grow beyond rounding): the last digits that a
/// trust region leaves.
void polish(const LeastSquaresProblem& problem, std::vector<double>& p, double rank_tolerance);

/// Largest |step_j| in standard deviations; components below 1e-10 of the parameter's size count as nothing.
double step_in_deviations(const Linearisation& at, const std::vector<double>& p, std::size_t residuals);

}  // namespace softgrain
