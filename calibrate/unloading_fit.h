// The unloading branch of a press test: what of the depth stays, and how steeply the force falls.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/data/force_curves.h"
#include "common/data/law_card.h"

namespace softgrain {

/// A fitted branch, or why there is none; both empty: nothing was unloaded.
struct UnloadingFit {
  std::optional<UnloadingLaw> law;
  std::string remark;
};

/// Fits UnloadingLaw to all unloadings of the samples, least squares of the force,
///   F = A [(Delta - Delta_p)/(Delta_max - Delta_p)]^exponent, Delta_p = delta + residual (Delta_max - delta),
/// with an A for each unloading: samples of one law differ in their force, and creep at the turning point lowers it.
/// Unloadings without readings, or that begin below the threshold or without force, count in no number.
/// `delta` and `loading_exponent` b are those of the loading law. Errors: of several samples by leaving out one after
/// the other (jackknife; Efron and Tibshirani 1993, ch. 11) with Student's t, so that they hold what samples differ by;
/// of one sample from its residuals, as many of which count as are not correlated. That of the residual holds the error
/// of delta. An exponent on its bound, least_unloading_exponent(), and a residual on kLargestResidual are said to be so.
UnloadingFit fit_unloading(const std::vector<ForceCurve>& samples, const Estimate& delta, double loading_exponent);

}  // namespace softgrain
