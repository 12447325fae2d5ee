// What is in the directory of a run, as far as it is set beside others.
#pragma once

#include <string>
#include <vector>

#include "pipelines/results/set_summary.h"

namespace softgrain {

/// Status (good where it has no summary), time and numbers of the run in `directory`, into its entry. Throws
/// IoError where it holds no results or damaged ones.
void read_numbers(const std::string& directory, RunEntry& entry);

}  // namespace softgrain
