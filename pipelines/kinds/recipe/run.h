// Parts of a run of a recipe.
#pragma once

#include "pipelines/kinds/recipe/scene.h"
#include "pipelines/kinds/recipe/summary.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/run/findings.h"

namespace softgrain {

inline constexpr const char* kMaterialCardFile = "material_card.toml";

/// Whether the check tells which way of joining levels does better: it holds a level more than the mixtures of two that
/// both were fitted to, or it is the whole itself.
bool tells_ways(const RecipeScene& scene);
inline constexpr const char* kTwoLevelsTellNothing =
    "a check of two levels lies between mixtures that were measured, to which both ways of joining levels are fitted: "
    "it "
    "cannot tell which way does better over more levels, and the value is the middle of both; more grains ([check] "
    "grains) check three levels";

/// Levels, packings, time, and what to mind. Throws InputError, IoError.
void check_recipe(const Scene& scene, Findings& out);

KindResults recipe_results();

namespace report {
std::string recipe_section(const RunData& run);
}

}  // namespace softgrain
