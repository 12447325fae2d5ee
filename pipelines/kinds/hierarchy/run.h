// Scene kind "hierarchy" for softgrain run.
#pragma once

#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// Level by level from the finest to the coarsest, then on to the fixed point, then the resolved check of two decades.
/// Writes law_table_level_K.toml, crowd_level_K.h5, law_table.toml (coarsest level), summary.json and the report.
/// Status not_usable when a level has no law, or the fixed point was not reached.
SceneKind hierarchy_kind();

/// Counts, overlaps, memory and time of its levels. Throws BadInput.
void check_hierarchy(const Scene& scene, Findings& out);

}  // namespace softgrain
