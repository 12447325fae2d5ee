// Scene kind "law-table": a soft particle is measured with several neighbours at once.
#pragma once

#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// Measures and fits; writes crowd.h5, law_table.toml, law_table.h5, summary.json and the report. Status not_usable
/// when a recorded point did not converge or the best law is not good.
SceneKind law_table_kind();

/// Counts, overlaps, memory, time, and what the table will lack. Throws BadInput.
void check_law_table(const Scene& scene, Findings& out);

}  // namespace softgrain
