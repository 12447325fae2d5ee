// Bootstrap over packings: refits to resampled ensembles, and quantiles of what they give.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "calibrate/threshold_model.h"

namespace softgrain {

struct BootstrapInput {
  std::array<CurveSamples, kLawCurves> samples;  ///< curves that take no part are empty
  FitCurves curves;                              ///< the full ensemble: its sigma weights every replicate
  double delta_limit = 0.0;
  JointParameters start;  ///< the fit to the full ensemble
};

struct BootstrapResult {
  std::vector<std::array<double, 7>> replicates;
  int failed = 0;
  int at_bound = 0;
};

/// Draws packings with replacement and refits. Replicate r depends on (seed, stream, r) alone, not on threads.
BootstrapResult bootstrap(const BootstrapInput& input, int replicates, std::uint64_t seed, std::uint64_t stream);

/// Quantiles 2.5 % and 97.5 % (linear between order statistics); infinite when there are no values.
std::pair<double, double> interval95(std::vector<double> values);

}  // namespace softgrain
