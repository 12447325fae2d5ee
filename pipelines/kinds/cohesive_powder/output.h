// What was measured on a powder, for files and summaries.
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

}  // namespace softgrain
