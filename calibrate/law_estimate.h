// The parts of a law card that follow from data, fit and replicates: descriptions, estimates with intervals, goodness
// of fit.
#pragma once

#include <array>

#include "calibrate/curve_samples.h"
#include "calibrate/threshold_fit.h"
#include "calibrate/threshold_model.h"

namespace softgrain {

using LawSamples = std::array<CurveSamples, kLawCurves>;
using LawMeans = std::array<CurveMeans, kLawCurves>;

/// Range, counts, table and largest grain overlap of the data behind a law.
void describe_data(const RunList& runs, const LawSamples& samples, const LawMeans& means, FitReport& report);

/// One curve's law from its parameters (order of kLawParameterNames): standard errors from report.law.covariance
/// (infinite when `errors_known` is false), intervals from report.replicates (infinite when there are none).
ThresholdPowerLaw estimated_law(const FitReport& report, const std::array<double, 7>& parameters, std::size_t curve,
                                bool errors_known);

/// chi^2 per degree of freedom of the packing means above threshold, and its tail probability; both 0 without freedom.
void fill_goodness(const FitCurves& curves, const JointParameters& found, double noise_floor, PairLaw& law);

}  // namespace softgrain
