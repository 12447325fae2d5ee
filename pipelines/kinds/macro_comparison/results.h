// What comparisons of laws with twins leave behind.
#pragma once

#include "pipelines/results/kind_results.h"

namespace softgrain {

KindResults macro_comparison_results();

namespace report {
std::string macro_scenes_section(const RunData& run);  ///< every law and both twins on every scene: error and cost
}

}  // namespace softgrain
