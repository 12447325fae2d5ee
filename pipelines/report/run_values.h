// What the kinds say of a run directory, gathered.
#pragma once

#include <string>
#include <vector>

#include "pipelines/report/run_data.h"
#include "pipelines/results/run_values.h"

namespace softgrain::report {

/// Numbers by which a run is set beside others; those that are not finite left out.
std::vector<RunValue> values_of(const RunData& run);

/// Curves of a run directory. Throws IoError where it holds no results, or damaged ones.
std::vector<RunCurve> curves_of(const std::string& directory);

}  // namespace softgrain::report
