// A general fitter for non-linear least squares: minimise S(p) = sum_i r_i(p)^2, within bounds, from several starts.
// Ceres does the trust-region work behind this header; the result says why it ended and how well it determines each
// parameter.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace softgrain {

/// Writes r(p); returns false where the model is not defined (the step is then rejected).
using ResidualFunction = std::function<bool(std::span<const double> parameters, std::span<double> residuals)>;

/// Writes dr_i/dp_j, row-major (residuals x parameters); returns false where it is not defined.
using JacobianFunction = std::function<bool(std::span<const double> parameters, std::span<double> jacobian)>;

/// g(p): residuals are smooth where none of these changes its sign, and continuous everywhere.
using KinkFunction = std::function<std::vector<double>(std::span<const double> parameters)>;

/// Closed interval of one parameter; open by default, and of zero width to fix the parameter.
struct ParameterBounds {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

struct LeastSquaresProblem {
  std::size_t residuals = 0;
  ResidualFunction evaluate;
  JacobianFunction jacobian;            ///< empty: central differences
  std::vector<ParameterBounds> bounds;  ///< empty, or one per parameter
  KinkFunction kinks = nullptr;         ///< empty: residuals are smooth; else `jacobian` must be given
};

struct LeastSquaresOptions {
  int max_iterations = 5000;  ///< largest number of iterations of each trust-region run
  bool thorough = true;       ///< try every strategy and keep the best; false: the first one alone
  bool scale_covariance =
      true;  ///< covariance times S/(degrees of freedom); false when residuals are in units of known errors
  double rank_tolerance =
      1e-11;  ///< singular values of the column-scaled Jacobian below this share of the largest count as zero
};

enum class FitEnd {
  not_run,
  converged,  ///< the Gauss-Newton step left at the end is negligible; on kinks, that with slopes between those of
              ///< their sides
  stalled,    ///< no strategy could lower S further, yet the step left is not negligible
  capped,     ///< iteration limit
  failed      ///< the model could not be evaluated at any start, or the problem is ill-posed
};

std::string to_string(FitEnd end);

struct LeastSquaresFit {
  FitEnd end = FitEnd::not_run;
  std::string message = "not run";  ///< one sentence: why it ended
  std::vector<double> parameters;
  std::vector<double> covariance;           ///< n x n row-major; rows of parameters at a bound are zero; at a minimum
                                            ///< on kinks an upper bound (calibrate/kink_minimum.h)
  std::vector<double> standard_deviations;  ///< infinite where the data do not determine the parameter
  std::vector<bool> at_bound;               ///< S would fall further outside the bound
  int rank = 0;                             ///< rank of the Jacobian over parameters that are not at a bound
  bool rank_deficient = false;
  double residual_sum_of_squares = std::numeric_limits<double>::infinity();
  double residual_standard_deviation = 0.0;  ///< sqrt(S / degrees of freedom)
  std::ptrdiff_t degrees_of_freedom = 0;     ///< residuals - parameters
  int iterations = 0;                        ///< iterations of all strategies and starts together
  double step_left = 0.0;                    ///< largest Gauss-Newton step left, in standard deviations
  std::size_t kinks = 0;                     ///< number of kinks of the residuals that the minimum lies on
  std::string strategy;                      ///< strategy that gave the best result
  std::size_t start = 0;                     ///< index of the start that gave the best result

  [[nodiscard]] bool usable() const { return end == FitEnd::converged && !rank_deficient; }
};

/// Runs every strategy from every start, polishes each end point and keeps the one with the smallest S. While that one
/// is not usable (and `thorough` holds) further starts are spread around the given ones, a decade to either side. A fit
/// that does not converge is searched for a minimum on the problem's kinks.
/// Throws InputError when starts, bounds and residuals do not fit together; a fit that goes wrong is reported, not
/// thrown.
LeastSquaresFit fit_least_squares(const LeastSquaresProblem& problem, const std::vector<std::vector<double>>& starts,
                                  const LeastSquaresOptions& options = {});

}  // namespace softgrain
