#include "calibrate/residual_draws.h"

#include <algorithm>
#include <cmath>

namespace softgrain {

ResidualDraws::ResidualDraws(const BootstrapInput& input, const std::vector<GivenError>& given) : input_(input) {
  given_[0] = given;
  for (std::size_t j = 0; j < kLawCurves; ++j)
    if (input.curves[j].present()) prepare(j);
}

void ResidualDraws::prepare(std::size_t j) {
  const CurveSamples& s = input_.samples[j];
  const std::vector<double>& sigma = input_.curves[j].sigma;
  Curve& c = curves_[j];
  for (const double d : s.delta) c.fitted.push_back(input_.start.value(j, d));
  std::vector<double> standardised(s.value.size(), std::numeric_limits<double>::quiet_NaN());
  double chi2 = 0.0;
  double points = 0.0;
  for (std::size_t i = 0; i < s.packings; ++i)
    for (std::size_t k = 0; k < s.delta.size(); ++k) {
      const double z = (s.at(i, k) - c.fitted[k]) / sigma[k];
      if (std::isnan(z)) continue;
      standardised[i * s.delta.size() + k] = z;
      chi2 += z * z;
      points += 1.0;
    }
  c.block = correlation_length(standardised, s.packings);
  const double parameters = j == 0 ? 3.0 : 2.0;
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
        drawn.value[i * n + k] = curves_[j].fitted[k] + number * amplitude;
      }
    }
    if (j == 0) set_to_zero(drawn);
    out[j].means = means_of(drawn);
    out[j].sigma = experiment_errors(drawn, out[j].means, given_[j], input_.scatter_floor);
  }
  return out;
}

}  // namespace softgrain
