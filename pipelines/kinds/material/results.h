// What runs of kind "material" leave behind.
#pragma once

#include "common/data/macro_result.h"
#include "pipelines/results/kind_results.h"

namespace softgrain {

/// Name that the curves of resolved grains bear as their engine.
inline constexpr const char* kMaterialEngine = "material";

KindResults material_results();

/// p = (sigma_x + sigma_y + sigma_z)/3 at every point [Pa].
std::vector<double> mean_stresses(const MacroCurve& curve);

namespace report {
std::string material_section(const RunData& run);  ///< pressure over solid fraction, stresses, who bears them
}

}  // namespace softgrain
