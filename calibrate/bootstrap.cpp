#include "calibrate/bootstrap.h"

#include <gsl/gsl_statistics_double.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "calibrate/joint_fit.h"
#include "calibrate/replicates.h"
#include "calibrate/residual_draws.h"
#include "common/core/limits.h"
#include "common/core/random.h"
#include "common/core/statistics.h"

namespace softgrain {

namespace {

enum class Outcome { failed, inside, at_bound };

struct Replicate {
  Outcome outcome = Outcome::failed;
  std::array<double, 7> law{};
};

/// Means of one replicate, made from random numbers.
using DrawCurves = std::function<FitCurves(RandomStream&)>;

FitCurves draw_packings(const BootstrapInput& input, RandomStream& stream) {
  const std::size_t packings = input.samples[0].packings;
  std::vector<int> multiplicity(packings, 0);
  for (std::size_t i = 0; i < packings; ++i) ++multiplicity[stream.below(packings)];
  FitCurves curves = input.curves;
  for (std::size_t j = 0; j < kLawCurves; ++j)
    if (curves[j].present()) curves[j].means = means_of(input.samples[j], multiplicity);
  return curves;
}

Replicate refit(const BootstrapInput& input, const FitCurves& curves) {
  JointFit joint = refit_joint(curves, input.delta_limit, input.start);
  for (const double share : input.threshold_shares) {
    JointParameters from = input.start;
    from.delta = std::min(share * from.delta, input.delta_limit);
    JointFit other = refit_joint(curves, input.delta_limit, from);
    if (other.fit.residual_sum_of_squares < joint.fit.residual_sum_of_squares) joint = std::move(other);
  }
  Replicate out;
  out.law = joint.parameters.law_parameters();
  const bool finite = std::ranges::all_of(out.law, [](double x) { return std::isfinite(x); });
  if (!finite || joint.fit.end == FitEnd::failed || joint.fit.rank_deficient) return out;
  const bool bound =
      joint.delta_at_limit || std::ranges::find(joint.exponent_at_bound, true) != joint.exponent_at_bound.end();
  out.outcome = bound ? Outcome::at_bound : Outcome::inside;
  return out;
}

BootstrapResult refit_all(const BootstrapInput& input, const DrawCurves& draw, int replicates, std::uint64_t seed,
                          std::uint64_t stream) {
  BootstrapResult out;
  for (const Replicate& one : bootstrap_replicates(replicates, seed, stream << 32U, "refitting to drawn packings",
                                                   [&](RandomStream& random) { return refit(input, draw(random)); })) {
    if (one.outcome == Outcome::failed) {
      ++out.failed;
      continue;
    }
    if (one.outcome == Outcome::at_bound) ++out.at_bound;
    out.replicates.push_back(one.law);
  }
  return out;
}

}  // namespace

BootstrapResult bootstrap(const BootstrapInput& input, int replicates, std::uint64_t seed, std::uint64_t stream) {
  return refit_all(
      input, [&](RandomStream& random) { return draw_packings(input, random); }, replicates, seed, stream);
}

BootstrapResult residual_bootstrap(const BootstrapInput& input, const std::vector<GivenError>& given, int replicates,
                                   std::uint64_t seed, std::uint64_t stream) {
  const ResidualDraws draws(input, given);
  // A dense curve has a kink at every point, and a local minimum between many of them: one walk would stay near its
  // start.
  BootstrapInput searched = input;
  searched.threshold_shares = {0.7, 0.85, 1.15, 1.3};
  return refit_all(
      searched, [&](RandomStream& random) { return draws.draw(random); }, replicates, seed, stream);
}

std::vector<double> replicate_covariance(const std::vector<std::array<double, 7>>& replicates) {
  std::vector<double> out(49, 0.0);
  const std::size_t n = replicates.size();
  if (n < 2) return out;
  const double* first = replicates.front().data();
  for (std::size_t i = 0; i < 7; ++i)
    for (std::size_t j = 0; j < 7; ++j) out[i * 7 + j] = gsl_stats_covariance(first + i, 7, first + j, 7, n);
  return out;
}

double scatter_of(const std::vector<double>& values) {
  return values.size() < 2 ? kInfinity : mean_error(values).deviation;
}

std::pair<double, double> interval95(const std::vector<double>& values) {
  if (values.empty()) return {-kInfinity, kInfinity};
  return {quantile(values, 0.025), quantile(values, 0.975)};
}

}  // namespace softgrain
