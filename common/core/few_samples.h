// What few samples leave open: Student's t in the place of the normal distribution.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>

#include "common/core/limits.h"
#include "common/core/statistics.h"

namespace softgrain {

/// Quantile p of Student's t: 2.776445 for p = 0.975 and four degrees of freedom; infinite below one degree.
double student_quantile(double p, double degrees);
inline double student95(double degrees) { return student_quantile(0.975, degrees); }

/// student95() over that of the normal distribution, 1.42 for four degrees: intervals of normal draws are too narrow by
/// this factor.
double student_over_normal(double degrees);

/// 95 % interval about a value: {0.6, 3.4} for 2 with a standard error of 0.5 and four degrees of freedom.
std::pair<double, double> student_interval(double value, double error, double degrees);

/// A value with its standard error and 95 % interval, which ends at the bounds. Below one degree of freedom nothing is
/// known: the error and both ends are infinite.
Estimate student_estimate(double value, double error, double degrees, double least = -kInfinity,
                          double most = kInfinity);

/// Mean of samples with its 95 % interval, which ends at the bounds; that of one sample is not known.
Estimate mean_estimate(const MeanError& mean, double least = -kInfinity, double most = kInfinity);

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
