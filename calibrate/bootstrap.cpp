#include "calibrate/bootstrap.h"

#include <gsl/gsl_statistics_double.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "calibrate/draws.h"
#include "calibrate/threshold_model.h"
#include "common/core/few_samples.h"
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

ResidualDraws::ResidualDraws(const BootstrapInput& input, const std::vector<GivenError>& given) : input_(input) {
  given_[0] = given;
  for (std::size_t j = 0; j < kLawCurves; ++j)
    if (input.curves[j].present()) prepare(j);
}

/// The factor of each sample to the fitted curve, by least squares; 1 for a single one.
std::vector<double> ResidualDraws::factors(std::size_t j) const {
  const CurveSamples& s = input_.samples[j];
  std::vector<double> out(s.packings, 1.0);
  for (std::size_t i = 0; s.packings > 1 && i < s.packings; ++i) {
    double product = 0.0;
    double square = 0.0;
    for (std::size_t k = 0; k < s.delta.size(); ++k) {
      if (std::isnan(s.at(i, k))) continue;
      const double weight = 1.0 / (input_.curves[j].sigma[k] * input_.curves[j].sigma[k]);
      product += weight * s.at(i, k) * curves_[j].fitted[k];
      square += weight * curves_[j].fitted[k] * curves_[j].fitted[k];
    }
    if (square > 0.0) out[i] = product / square;
  }
  return out;
}

void ResidualDraws::prepare(std::size_t j) {
  const CurveSamples& s = input_.samples[j];
  const std::vector<double>& sigma = input_.curves[j].sigma;
  Curve& c = curves_[j];
  for (const double d : s.delta) c.fitted.push_back(input_.start.value(j, d));
  const std::vector<double> factor = j == 0 ? factors(j) : std::vector<double>(s.packings, 1.0);
  if (j == 0 && s.packings > 1)
    c.between = mean_error(factor).deviation * student_over_normal(static_cast<double>(s.packings - 1));
  std::vector<double> standardised(s.value.size(), std::numeric_limits<double>::quiet_NaN());
  double chi2 = 0.0;
  double points = 0.0;
  for (std::size_t i = 0; i < s.packings; ++i)
    for (std::size_t k = 0; k < s.delta.size(); ++k) {
      const double z = (s.at(i, k) - factor[i] * c.fitted[k]) / sigma[k];
      if (std::isnan(z)) continue;
      standardised[i * s.delta.size() + k] = z;
      chi2 += z * z;
      points += 1.0;
    }
  c.block = correlation_length(standardised, s.packings);
  const double parameters = j == 0 ? 2.0 + static_cast<double>(s.packings) : 2.0;
  const double freedom = std::max(points - parameters, 1.0);
  // Errors as the fit weights points, to the size of the residuals; given ones are never taken to be smaller.
  const double size = std::max(given_[j].empty() ? 0.0 : 1.0, std::sqrt(chi2 / freedom));
  c.amplitude = standardised;
  for (std::size_t i = 0; i < s.packings; ++i)
    for (std::size_t k = 0; k < s.delta.size(); ++k) {
      double& a = c.amplitude[i * s.delta.size() + k];
      if (!std::isnan(a)) a = size * sigma[k];
    }
}

/// Sets drawn samples to zero as the measured ones were: by the mean of what lies below the threshold, so that its
/// error is in the intervals.
void ResidualDraws::set_to_zero(CurveSamples& drawn) const {
  const std::size_t n = drawn.delta.size();
  for (std::size_t i = 0; i < drawn.packings && i < input_.zeroed_below.size(); ++i) {
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t k = 0; k < n && drawn.delta[k] < input_.zeroed_below[i]; ++k) {
      if (std::isnan(drawn.value[i * n + k])) continue;
      sum += drawn.value[i * n + k];
      count += 1.0;
    }
    for (std::size_t k = 0; count > 0.0 && k < n; ++k) drawn.value[i * n + k] -= sum / count;
  }
}

FitCurves ResidualDraws::draw(RandomStream& random) const {
  FitCurves out = input_.curves;
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    if (!out[j].present()) continue;
    CurveSamples drawn = input_.samples[j];
    const std::size_t n = drawn.delta.size();
    for (std::size_t i = 0; i < drawn.packings; ++i) {
      const double factor = curves_[j].between > 0.0 ? 1.0 + curves_[j].between * random.normal() : 1.0;
      double number = 0.0;
      auto left = static_cast<std::size_t>(random.below(curves_[j].block));  // blocks begin anywhere
      if (left > 0) number = random.normal();
      for (std::size_t k = 0; k < n; ++k) {
        const double amplitude = curves_[j].amplitude[i * n + k];
        if (std::isnan(amplitude)) continue;
        if (left == 0) {
          number = random.normal();
          left = curves_[j].block;
        }
        --left;
        drawn.value[i * n + k] = factor * curves_[j].fitted[k] + number * amplitude;
      }
    }
    if (j == 0) set_to_zero(drawn);
    out[j].means = means_of(drawn);
    out[j].sigma = experiment_errors(drawn, out[j].means, given_[j], input_.scatter_floor);
  }
  return out;
}

}  // namespace softgrain
