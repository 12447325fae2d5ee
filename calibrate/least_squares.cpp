#include "calibrate/least_squares.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "calibrate/kink_minimum.h"
#include "calibrate/trust_region.h"
#include "common/core/error.h"

namespace softgrain {

namespace {

/// A fit counts as converged when the step left is below this share of a standard deviation.
constexpr double kStepTolerance = 1e-5;
/// Restarts of one strategy with parameters rescaled to where the last run ended.
constexpr int kMaxRounds = 4;
/// Sums closer than this share are equal: the earlier end point stays (models with a symmetry have several equal
/// minima).
constexpr double kSumTie = 1e-9;
/// Further starts, spread a decade around the given ones, tried only while the best end point is not usable.
constexpr std::size_t kSpreadStarts = 16;

void require_consistent(const LeastSquaresProblem& problem, const std::vector<std::vector<double>>& starts) {
  if (starts.empty() || starts.front().empty()) throw InputError("fit: no start values given");
  if (!problem.evaluate || problem.residuals == 0) throw InputError("fit: no residuals given");
  if (problem.kinks && !problem.jacobian) throw InputError("fit: kinks need slopes of either side, so a Jacobian");
  for (const auto& start : starts) {
    if (start.size() != starts.front().size()) throw InputError("fit: starts have different numbers of parameters");
    if (!problem.bounds.empty() && problem.bounds.size() != start.size())
      throw InputError("fit: one pair of bounds per parameter is needed");
    for (std::size_t j = 0; j < problem.bounds.size(); ++j)
      if (!(problem.bounds[j].low <= start[j] && start[j] <= problem.bounds[j].high))
        throw InputError(fmt::format("fit: start value {} of parameter {} lies outside its bounds [{}, {}]", start[j],
                                     j, problem.bounds[j].low, problem.bounds[j].high));
  }
}

struct EndPoint {
  bool ran = false;
  bool capped = false;
  double sum = std::numeric_limits<double>::infinity();
  std::vector<double> parameters;
  std::string message;
};

double sum_of_squares(const LeastSquaresProblem& problem, const std::vector<double>& p) {
  std::vector<double> r(problem.residuals);
  if (!problem.evaluate(p, r)) return std::numeric_limits<double>::infinity();
  double sum = 0.0;
  for (const double x : r) sum += x * x;
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

/// One strategy from one start, restarted with new scales as long as that lowers S, then polished.
EndPoint run_strategy(const LeastSquaresProblem& problem, const std::vector<double>& start,
                      const TrustRegionStrategy& strategy, const LeastSquaresOptions& options, int& iterations) {
  EndPoint best;
  std::vector<double> p = start;
  for (int round = 0; round < (options.thorough ? kMaxRounds : 1); ++round) {
    const TrustRegionEnd end = run_trust_region(problem, p, strategy, options);
    iterations += end.iterations;
    if (!end.ran) break;
    p = end.parameters;
    const double sum = sum_of_squares(problem, p);
    const bool settled = best.ran && sum >= best.sum * (1.0 - 1e-12);
    if (!best.ran || sum <= best.sum) best = {true, end.capped, sum, p, end.message};
    if (settled) break;
  }
  if (!best.ran) return best;
  polish(problem, best.parameters, options.rank_tolerance);
  best.sum = sum_of_squares(problem, best.parameters);
  return best;
}

std::string on_kinks(std::size_t kinks) {
  if (kinks == 0) return "";
  return fmt::format(" on {} of the residuals, where the sum of squares rises to either side",
                     kinks == 1 ? "a kink" : fmt::format("{} kinks", kinks));
}

/// Covariance, deviations and the reason of the end, from the linearisation at the best point.
void describe(const LeastSquaresProblem& problem, const LeastSquaresOptions& options, const EndPoint& best,
              const Linearisation& at, LeastSquaresFit& fit) {
  const std::size_t n = best.parameters.size();
  fit.parameters = best.parameters;
  fit.residual_sum_of_squares = best.sum;
  fit.degrees_of_freedom = static_cast<std::ptrdiff_t>(problem.residuals) - static_cast<std::ptrdiff_t>(n);
  const double freedom = std::max<double>(1.0, static_cast<double>(fit.degrees_of_freedom));
  fit.residual_standard_deviation = std::sqrt(best.sum / freedom);
  fit.at_bound = at.at_bound;
  fit.rank = at.rank;
  fit.rank_deficient = at.rank_deficient;
  fit.covariance = at.inverse;
  fit.standard_deviations.resize(n);
  if (options.scale_covariance)
    for (double& c : fit.covariance) c *= best.sum / freedom;
  for (std::size_t j = 0; j < n; ++j) {
    if (at.undetermined[j]) fit.covariance[j * n + j] = std::numeric_limits<double>::infinity();
    fit.standard_deviations[j] = std::sqrt(fit.covariance[j * n + j]);
  }
  fit.step_left = at.defined ? step_in_deviations(at, best.parameters, problem.residuals) : HUGE_VAL;
  if (!at.defined) {
    fit.end = FitEnd::failed;
    fit.message = "the Jacobian is not defined at the end point";
  } else if (fit.step_left <= kStepTolerance) {
    fit.end = FitEnd::converged;
    fit.message =
        fmt::format("converged{}: the step left is {:.1e} standard deviations", on_kinks(fit.kinks), fit.step_left);
  } else {
    fit.end = best.capped ? FitEnd::capped : FitEnd::stalled;
    fit.message = fmt::format("{}: a step of {:.1e} standard deviations is left ({})", to_string(fit.end),
                              fit.step_left, best.message);
  }
  if (fit.rank_deficient)
    fit.message +=
        fmt::format("; the data determine {} of {} free parameters", fit.rank,
                    n - static_cast<std::size_t>(std::count(fit.at_bound.begin(), fit.at_bound.end(), true)));
}

void describe(const LeastSquaresProblem& problem, const LeastSquaresOptions& options, const EndPoint& best,
              LeastSquaresFit& fit) {
  describe(problem, options, best, linearise(problem, best.parameters, options.rank_tolerance), fit);
}

/// Ends a fit that stalled, or went to and fro across a kink until its iterations were over, in the minimum that it
/// stopped short of, where there is one.
void settle_on_kinks(const LeastSquaresProblem& problem, const LeastSquaresOptions& options, const EndPoint& best,
                     LeastSquaresFit& fit) {
  const auto found = find_kink_minimum(problem, best.parameters, options.rank_tolerance);
  if (!found || found->at.residual_sum_of_squares > best.sum * (1.0 + kSumTie)) return;
  if (step_in_deviations(found->at, found->parameters, problem.residuals) > kStepTolerance) return;
  fit.kinks = found->kinks;
  describe(problem, options, {true, false, found->at.residual_sum_of_squares, found->parameters, best.message},
           found->at, fit);
}

/// A clearly lower sum; or a slightly lower one at the same minimum (more digits).
bool improves(const EndPoint& end, const EndPoint& best) {
  constexpr double kSameMinimum = 1e-2;
  if (!best.ran || end.sum < best.sum * (1.0 - kSumTie)) return true;
  if (!(end.sum < best.sum)) return false;
  for (std::size_t j = 0; j < best.parameters.size(); ++j)
    if (std::abs(end.parameters[j] - best.parameters[j]) > kSameMinimum * std::abs(best.parameters[j])) return false;
  return true;
}

/// Every strategy from one start; keeps the best end point so far.
void run_strategies(const LeastSquaresProblem& problem, const std::vector<double>& start, std::size_t index,
                    const LeastSquaresOptions& options, EndPoint& best, LeastSquaresFit& fit) {
  const auto& strategies = trust_region_strategies();
  const std::size_t used = options.thorough ? strategies.size() : 1;
  for (std::size_t k = 0; k < used; ++k) {
    EndPoint end = run_strategy(problem, start, strategies[k], options, fit.iterations);
    if (!end.ran || !improves(end, best)) continue;
    best = std::move(end);
    fit.strategy = strategies[k].name;
    fit.start = index;
  }
}

/// The k-th start around a given one: each parameter times 10^u, u even over [-1, 1] (Weyl sequence over square roots
/// of primes).
std::vector<double> spread_start(const LeastSquaresProblem& problem, const std::vector<double>& start, std::size_t k) {
  constexpr std::array<double, 12> kPrimes{2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};
  std::vector<double> p = start;
  for (std::size_t j = 0; j < p.size(); ++j) {
    const std::size_t turn = j / kPrimes.size();
    const double x =
        static_cast<double>(k) * std::sqrt(kPrimes[j % kPrimes.size()]) * (1.0 + static_cast<double>(turn));
    p[j] *= std::pow(10.0, 2.0 * (x - std::floor(x)) - 1.0);
    if (!problem.bounds.empty()) p[j] = std::clamp(p[j], problem.bounds[j].low, problem.bounds[j].high);
  }
  return p;
}

}  // namespace

std::string to_string(FitEnd end) {
  switch (end) {
    case FitEnd::not_run:
      return "not run";
    case FitEnd::converged:
      return "converged";
    case FitEnd::stalled:
      return "stalled";
    case FitEnd::capped:
      return "capped";
    case FitEnd::failed:
      return "failed";
  }
  return "unknown";
}

LeastSquaresFit fit_least_squares(const LeastSquaresProblem& problem, const std::vector<std::vector<double>>& starts,
                                  const LeastSquaresOptions& options) {
  require_consistent(problem, starts);
  LeastSquaresFit fit;
  EndPoint best;
  for (std::size_t k = 0; k < starts.size(); ++k) run_strategies(problem, starts[k], k, options, best, fit);
  if (best.ran) describe(problem, options, best, fit);
  for (std::size_t k = 0; options.thorough && !fit.usable() && k < kSpreadStarts; ++k) {
    const std::size_t origin = k % starts.size();
    run_strategies(problem, spread_start(problem, starts[origin], k + 1), origin, options, best, fit);
    if (best.ran) describe(problem, options, best, fit);
  }
  if (problem.kinks && (fit.end == FitEnd::stalled || fit.end == FitEnd::capped))
    settle_on_kinks(problem, options, best, fit);
  if (!best.ran) {
    fit.end = FitEnd::failed;
    fit.message = "failed: the model could not be evaluated at any start";
    fit.parameters = starts.front();
  }
  return fit;
}

}  // namespace softgrain
