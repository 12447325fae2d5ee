// Scene kind "law-table": a soft particle is measured with several neighbours at once.
#pragma once

#include "common/io/scene.h"
#include "pipelines/run_context.h"

namespace softgrain {

/// Measures and fits; writes crowd.h5, law_table.toml, law_table.h5, summary.json and the report. Status not_usable
/// when a recorded point did not converge or the best law is not good.
ExitStatus run_law_table(const Scene& scene, const CommonOptions& options);

}  // namespace softgrain
