// What macro runs leave behind.
#pragma once

#include "pipelines/results/kind_results.h"

namespace softgrain {

KindResults macro_results();

namespace report {
std::string macro_section(const RunData& run);  ///< stress and strain, law against resolved twin
}

}  // namespace softgrain
