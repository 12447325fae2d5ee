// In what the scenes differ that several runs were made from.
#pragma once

#include <string>
#include <vector>

#include "pipelines/results/set_summary.h"

namespace softgrain {

/// Every key whose value is not the same for all runs, with its value in each ("-": has none), from the scenes, seeds
/// and laws that summaries (of directories) and HDF5 files say they were made from. Titles are left out. Runs that do
/// not say their scene are passed over in silence: their values are "?".
std::vector<SweptKey> scene_differences(const std::vector<std::string>& paths);

}  // namespace softgrain
