#include "common/core/statistics.h"

#include <gsl/gsl_statistics_double.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/core/error.h"
#include "common/core/limits.h"

namespace softgrain {
namespace {

double sum(std::span<const double> values) { return std::accumulate(values.begin(), values.end(), 0.0); }

double quotient(double numerator, double denominator) { return denominator == 0.0 ? kNaN : numerator / denominator; }

/// `squares`: sum of squares about the mean.
MeanError from_squares(double n, double mean, double squares) {
  const double deviation = n > 1.0 ? std::sqrt(squares / (n - 1.0)) : kNaN;
  return {static_cast<std::size_t>(n), mean, deviation, deviation / std::sqrt(n)};
}

}  // namespace

MeanError mean_error(std::span<const double> values) {
  if (values.empty()) return {0, kNaN, kNaN, kNaN};
  const double mean = gsl_stats_mean(values.data(), 1, values.size());
  return from_squares(static_cast<double>(values.size()), mean, gsl_stats_tss_m(values.data(), 1, values.size(), mean));
}

MeanError mean_error(std::span<const double> values, std::span<const double> repetitions) {
  const double n = sum(repetitions);
  if (!(n > 0.0)) return {0, kNaN, kNaN, kNaN};
  const double mean = gsl_stats_wmean(repetitions.data(), 1, values.data(), 1, values.size());
  return from_squares(n, mean, gsl_stats_wtss_m(repetitions.data(), 1, values.data(), 1, values.size(), mean));
}

double quantile(std::vector<double> values, double p) {
  if (values.empty()) return kNaN;
  std::sort(values.begin(), values.end());
  // GSL interpolates at f (n - 1), counted from 0.
  const auto last = static_cast<double>(values.size() - 1);
  const double at = std::clamp(p * static_cast<double>(values.size() + 1) - 1.0, 0.0, last);
  return gsl_stats_quantile_from_sorted_data(values.data(), 1, values.size(), last > 0.0 ? at / last : 0.0);
}

RatioError paired_ratio(std::span<const double> candidate, std::span<const double> reference) {
  if (candidate.size() != reference.size()) throw BadInput("ratio of means: the two sets have different sizes");
  const double a = sum(candidate);
  const double b = sum(reference);
  const double ratio = quotient(a, b);
  const std::size_t n = candidate.size();
  if (n < 2) return {ratio, kNaN};
  double mean = 0.0;
  for (std::size_t i = 0; i < n; ++i) mean += quotient(a - candidate[i], b - reference[i]);
  mean /= static_cast<double>(n);
  double squares = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double without = quotient(a - candidate[i], b - reference[i]);
    squares += (without - mean) * (without - mean);
  }
  return {ratio, std::sqrt(squares * static_cast<double>(n - 1) / static_cast<double>(n))};
}

RatioError independent_ratio(const MeanError& candidate, const MeanError& reference) {
  const double ratio = quotient(candidate.mean, reference.mean);
  const double a = quotient(candidate.error, candidate.mean);
  const double b = quotient(reference.error, reference.mean);
  return {ratio, std::abs(ratio) * std::hypot(a, b)};
}

}  // namespace softgrain
