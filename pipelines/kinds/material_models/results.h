// What runs of kind "material-models" leave behind, beside the files of kind "material".
#pragma once

#include "pipelines/results/kind_results.h"

namespace softgrain {

KindResults material_models_results();

namespace report {
std::string material_models_section(const RunData& run);  ///< stress of truth and models, errors, error against cost
}

}  // namespace softgrain
