// softgrain run of kind "macro-comparison": every law and both resolved twins on the same scenes, error against cost.
#pragma once

#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// Runs all scenes and writes macro_SCENE.h5, macro_initial_SCENE.h5, comparison.json, table.md, table.csv,
/// summary.json and the report.
SceneKind macro_comparison_kind();

/// What every scene asks of its laws, and the time of all. Throws BadInput, FileTrouble.
void check_macro_comparison(const Scene& scene, Findings& out);

}  // namespace softgrain
