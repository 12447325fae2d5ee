// Means, ratios and their standard errors over packings or samples.
#pragma once

#include <cstddef>
#include <span>

namespace softgrain {

/// Mean of n values. `deviation` is the sample standard deviation, `error` = deviation / sqrt(n);
/// both are NaN for n < 2, the mean is NaN for n = 0.
struct MeanError {
  std::size_t n = 0;
  double mean;
  double deviation;
  double error;
};
MeanError mean_error(std::span<const double> values);

/// A ratio of two means with its standard error; NaN where it cannot be had.
struct RatioError {
  double ratio;
  double error;
};

/// mean(candidate) / mean(reference) of paired values, error by jackknife over the pairs.
/// Throws BadInput when the lengths differ.
RatioError paired_ratio(std::span<const double> candidate, std::span<const double> reference);

/// Ratio of two independent means, relative errors added in squares.
RatioError independent_ratio(const MeanError& candidate, const MeanError& reference);

}  // namespace softgrain
