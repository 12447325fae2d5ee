// How well single values of an experiment are known, when there are few samples or one.
#pragma once

#include <vector>

#include "calibrate/curve_samples.h"

namespace softgrain {

/// Standard error of one value of a curve, given from outside.
struct GivenError {
  double delta = 0.0;
  double error = 0.0;  ///< standard error in the unit of the curve (dimensionless)
};

/// Error per single sample at each Delta, the largest of: the scatter between samples (mean square over five
/// neighbours, because two or three samples alone say little about it); the roughness of the curves (distance of a
/// point from the line through its two neighbours, mean square over a quarter of the curve); what was given; and
/// floors: `scatter_floor` times the pooled value, 1e-4 of the largest mean.
std::vector<double> experiment_errors(const CurveSamples& samples, const CurveMeans& means,
                                      const std::vector<GivenError>& given, double scatter_floor);

/// Number of neighbouring points over which residuals (samples x Delta, row-major, NaN where absent) stay correlated:
/// twice the first lag at which the autocorrelation within samples is below 0.3, at least 1, at most the longest
/// sample.
std::size_t correlation_length(const std::vector<double>& residuals, std::size_t samples);

}  // namespace softgrain
