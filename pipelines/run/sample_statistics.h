// Mean and scatter of the scalars of several samples.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

namespace softgrain {

/// Statistics of every number in the objects, nested ones by their path ("rigidity.fixed.h"): {"mean", "deviation",
/// "samples"}, the deviation with n - 1. Samples where it is missing or null (undefined) do not count; without any, the
/// mean is null, with one the deviation. Flags, texts and lists are passed over.
nlohmann::json sample_statistics(const std::vector<nlohmann::json>& samples);

}  // namespace softgrain
