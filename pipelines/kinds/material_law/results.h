// What runs of kind "material-law" leave behind, beside the files of kind "material".
#pragma once

#include "pipelines/results/kind_results.h"

namespace softgrain {

inline constexpr const char* kCellLawFile = "cell_law.toml";

KindResults material_law_results();

namespace report {
std::string cell_law_section(const RunData& run);  ///< numbers of the law, excess pores, friction of the fines
}

}  // namespace softgrain
