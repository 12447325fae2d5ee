#include "common/core/few_samples.h"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>

namespace softgrain {

double student_quantile(double p, double degrees) {
  return degrees >= 1.0 ? gsl_cdf_tdist_Pinv(p, degrees) : kInfinity;
}

double student_over_normal(double degrees) { return student95(degrees) / kNormal95; }

std::pair<double, double> student_interval(double value, double error, double degrees) {
  const double half = student95(degrees) * error;
  return {value - half, value + half};
}

Estimate student_estimate(double value, double error, double degrees, double least, double most) {
  if (!(degrees >= 1.0)) return {value, kInfinity, -kInfinity, kInfinity};
  const auto [low, high] = student_interval(value, error, degrees);
  return {value, error, std::max(least, low), std::min(most, high)};
}

Estimate mean_estimate(const MeanError& mean, double least, double most) {
  return student_estimate(mean.mean, mean.error, static_cast<double>(mean.n) - 1.0, least, most);
}

double few_samples_factor(std::size_t samples) {
  if (samples < 2) return kInfinity;
  const auto n = static_cast<double>(samples);
  return std::sqrt(n / (n - 1.0)) * student95(n - 1.0) / kNormal95;
}

double factor_of_several(std::int64_t samples) {
  return samples > 1 ? few_samples_factor(static_cast<std::size_t>(samples)) : 1.0;
}

std::pair<double, double> widened(double value, double low, double high, double factor, bool positive) {
  const auto away = [&](double end) {
    if (!std::isfinite(end)) return end;
    if (positive && value > 0.0 && end > 0.0) return value * std::pow(end / value, factor);
    return end == value ? value : value + factor * (end - value);
  };
  const double least = away(std::min(low, value));
  return {positive ? std::max(0.0, least) : least, away(std::max(high, value))};
}

bool is_told_from_zero(std::size_t samples, double mean, double error) {
  if (samples < 2) return true;
  return std::abs(mean) > student95(static_cast<double>(samples) - 1.0) * error;
}

}  // namespace softgrain
