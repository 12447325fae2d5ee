// softgrain run SCENE.toml of kind "inverse": the soft particle whose curve comes nearest to a target.
#pragma once

#include "pipelines/run/findings.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// Searches, measures once more at the answer with other packings, writes measurements.h5 (of that), evaluations.csv,
/// summary.json and the report. Status 3 when the target is not reached.
SceneKind inverse_kind();

/// What follows from the scene without running it.
void check_inverse(const Scene& scene, Findings& out);

}  // namespace softgrain
