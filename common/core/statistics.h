// Statistics of samples: mean, scatter, quantiles, ratios of means, numbers with their errors. GSL does the sums.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <ranges>
#include <span>
#include <vector>

namespace softgrain {

/// 97.5 % quantile of the normal distribution: 95 % lie within so many standard deviations.
inline constexpr double kNormal95 = 1.959963984540054;

/// Mean of n values. `deviation` is the sample standard deviation (n - 1), `error` = deviation / sqrt(n);
/// both are NaN for n < 2, the mean is NaN for n = 0.
struct MeanError {
  std::size_t n = 0;
  double mean;
  double deviation;
  double error;

  /// Where a single value counts as one without scatter.
  [[nodiscard]] double deviation_or_zero() const { return n > 1 ? deviation : 0.0; }
  [[nodiscard]] double error_or_zero() const { return n > 1 ? error : 0.0; }
};
MeanError mean_error(std::span<const double> values);
/// Value k counts `repetitions[k]` times: a whole number, 0 leaves it out.
MeanError mean_error(std::span<const double> values, std::span<const double> repetitions);

/// Mean over the values that are finite; n counts these.
MeanError finite_mean(std::span<const double> values);

/// The same of what a function, or a member of each part, gives.
template <std::ranges::input_range Range, class ValueOf>
MeanError finite_mean(const Range& parts, ValueOf value_of) {
  std::vector<double> values;
  std::ranges::transform(parts, std::back_inserter(values), value_of);
  return finite_mean(values);
}

/// A sample as it grows.
class Tally {
 public:
  void add(double value, double repetitions = 1.0) {
    values_.push_back(value);
    repetitions_.push_back(repetitions);
  }
  [[nodiscard]] MeanError statistics() const { return mean_error(values_, repetitions_); }
  [[nodiscard]] double mean() const { return statistics().mean; }

 private:
  std::vector<double> values_;
  std::vector<double> repetitions_;
};

/// The value below which a share p of what a sample was drawn from lies: linear between order statistics x_1..x_n at
/// p (n + 1), within the extremes. NaN without values.
double quantile(std::vector<double> values, double p);

/// Slope dy/dx at the first of some points near each other, of a parabola by least squares through all of them (of the
/// line through two). NaN with fewer points or where all x are alike.
double slope_at_first(const std::vector<double>& x, const std::vector<double>& y);

/// A ratio of two means with its standard error; NaN where it cannot be had.
struct RatioError {
  double ratio;
  double error;
};

/// mean(candidate) / mean(reference) of paired values, error by jackknife over the pairs.
/// Throws InputError when the lengths differ.
RatioError paired_ratio(std::span<const double> candidate, std::span<const double> reference);

/// Ratio of two independent means, relative errors added in squares.
RatioError independent_ratio(const MeanError& candidate, const MeanError& reference);

/// A number with its standard error and 95 % interval, in the unit of the number. An error that is not known is
/// infinite, and so are the ends.
struct Estimate {
  double value = 0.0;
  double standard_error = 0.0;
  double low = 0.0;
  double high = 0.0;
};

}  // namespace softgrain
