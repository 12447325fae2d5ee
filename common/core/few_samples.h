// What few samples leave open: Student's t in the place of the normal distribution.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

namespace softgrain {

/// 97.5 % quantile of Student's t; infinite below one degree of freedom.
double student95(double degrees);

/// Replicates of a bootstrap over n samples scatter by sqrt((n - 1)/n) of the standard error, which is itself estimated
/// from these n: quantiles of the replicates are too close to the value by sqrt(n/(n - 1)) t/1.96, t Student's with
/// n - 1 degrees of freedom (Efron and Tibshirani 1993, ch. 12; Hesterberg 2015, doi:10.1080/00031305.2015.1089789).
/// 1.35 for seven samples, 1.06 for 32; infinite for fewer than two.
double few_samples_factor(std::size_t samples);

/// few_samples_factor() for intervals from several samples; 1 for a single sample or an unknown number (0).
double factor_of_several(std::int64_t samples);

/// An interval widened about its value by a factor, on either side by itself. `positive`: of a quantity above 0,
/// widened in its logarithm, so that it stays above; in itself and cut off at 0 where one end is 0 already. Ends that
/// are not finite stay.
std::pair<double, double> widened(double value, double low, double high, double factor, bool positive);

/// Whether a mean over samples is told apart from 0: its 95 % interval (Student's) does not hold 0. One sample has no
/// interval and counts as determined: nothing is known against it.
bool is_told_from_zero(std::size_t samples, double mean, double error);

}  // namespace softgrain
