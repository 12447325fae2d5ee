#include "pipelines/compare/statistics.h"

#include <cmath>
#include <numeric>

#include "common/core/error.h"
#include "common/core/limits.h"

namespace softgrain {
namespace {

double sum(std::span<const double> values) { return std::accumulate(values.begin(), values.end(), 0.0); }

double quotient(double numerator, double denominator) { return denominator == 0.0 ? kNaN : numerator / denominator; }

}  // namespace

MeanError mean_error(std::span<const double> values) {
  const auto n = static_cast<double>(values.size());
  if (values.empty()) return {0, kNaN, kNaN, kNaN};
  const double mean = sum(values) / n;
  if (values.size() < 2) return {1, mean, kNaN, kNaN};
  double squares = 0.0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  const double deviation = std::sqrt(squares / (n - 1.0));
  return {values.size(), mean, deviation, deviation / std::sqrt(n)};
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
