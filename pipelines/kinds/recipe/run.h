// Parts of a run of a recipe.
#pragma once

#include "pipelines/kinds/recipe/scene.h"
#include "pipelines/kinds/recipe/summary.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/run/findings.h"

namespace softgrain {

inline constexpr const char* kMaterialCardFile = "material_card.toml";

/// Levels, packings, time, and what to mind. Throws BadInput, FileTrouble.
void check_recipe(const Scene& scene, Findings& out);

KindResults recipe_results();

namespace report {
std::string recipe_section(const RunData& run);
}

}  // namespace softgrain
