// What was measured on a powder, for files and summaries, and the mean and scatter of the scalars of several samples.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "common/io/hdf5_file.h"
#include "microsim/powder/powder_analysis.h"

namespace softgrain {

/// Histograms of several samples, their counts added up.
nlohmann::json histograms_json(const std::vector<const PowderForces*>& samples);

/// Data set "pairs", one row per contact or attracting pair (its columns are named in the attribute), the group
/// "histograms" and the scalars as text.
void write_analysis(const h5::Group& group, const PowderAnalysis& analysis);

/// Statistics of every number in the objects, nested ones by their path ("rigidity.fixed.h"): {"mean", "deviation",
/// "samples"}, the deviation with n - 1. Samples where it is missing or null (undefined) do not count; without any, the
/// mean is null, with one the deviation. Flags, texts and lists are passed over.
nlohmann::json sample_statistics(const std::vector<nlohmann::json>& samples);

}  // namespace softgrain
