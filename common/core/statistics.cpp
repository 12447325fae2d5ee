#include "common/core/statistics.h"

#include <gsl/gsl_multifit.h>
#include <gsl/gsl_statistics_double.h>

#include <algorithm>
#include <cmath>
#include <memory>
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

MeanError finite_mean(std::span<const double> values) {
  std::vector<double> finite;
  std::ranges::copy_if(values, std::back_inserter(finite), [](double v) { return std::isfinite(v); });
  return mean_error(finite);
}

double quantile(std::vector<double> values, double p) {
  if (values.empty()) return kNaN;
  std::sort(values.begin(), values.end());
  // GSL interpolates at f (n - 1), counted from 0.
  const auto last = static_cast<double>(values.size() - 1);
  const double at = std::clamp(p * static_cast<double>(values.size() + 1) - 1.0, 0.0, last);
  return gsl_stats_quantile_from_sorted_data(values.data(), 1, values.size(), last > 0.0 ? at / last : 0.0);
}

double slope_at_first(const std::vector<double>& x, const std::vector<double>& y) {
  double span = 0.0;
  for (const double one : x) span = std::max(span, std::abs(one - x.front()));
  if (x.size() < 2 || !(span > 0.0)) return kNaN;
  const std::size_t powers = std::min<std::size_t>(x.size(), 3);
  using Matrix = std::unique_ptr<gsl_matrix, decltype(&gsl_matrix_free)>;
  using Vector = std::unique_ptr<gsl_vector, decltype(&gsl_vector_free)>;
  using Space = std::unique_ptr<gsl_multifit_linear_workspace, decltype(&gsl_multifit_linear_free)>;
  const Matrix a(gsl_matrix_alloc(x.size(), powers), gsl_matrix_free);
  const Matrix covariance(gsl_matrix_alloc(powers, powers), gsl_matrix_free);
  const Vector b(gsl_vector_alloc(x.size()), gsl_vector_free);
  const Vector found(gsl_vector_alloc(powers), gsl_vector_free);
  const Space space(gsl_multifit_linear_alloc(x.size(), powers), gsl_multifit_linear_free);
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double t = (x[k] - x.front()) / span;
    for (std::size_t j = 0; j < powers; ++j) gsl_matrix_set(a.get(), k, j, std::pow(t, static_cast<double>(j)));
    gsl_vector_set(b.get(), k, y[k]);
  }
  double squares = 0.0;
  gsl_multifit_linear(a.get(), b.get(), found.get(), covariance.get(), &squares, space.get());
  return gsl_vector_get(found.get(), 1) / span;
}

RatioError paired_ratio(std::span<const double> candidate, std::span<const double> reference) {
  if (candidate.size() != reference.size()) throw InputError("ratio of means: the two sets have different sizes");
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
