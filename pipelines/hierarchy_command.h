// Scene kind "hierarchy" for softgrain run.
#pragma once

#include "common/io/scene.h"
#include "pipelines/run_context.h"

namespace softgrain {

/// Level by level from the finest to the coarsest, then on to the fixed point, then the resolved check of two decades.
/// Writes law_table_level_K.toml, crowd_level_K.h5, law_table.toml (coarsest level), summary.json and the report.
/// Status not_usable when a level has no law, or the fixed point was not reached.
ExitStatus run_hierarchy(const Scene& scene, const CommonOptions& options);

}  // namespace softgrain
