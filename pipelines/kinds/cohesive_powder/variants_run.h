// A powder in variants: one after another, and the table of them.
#pragma once

#include "common/io/scene.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

/// Runs each variant in DIR/NAME like a scene of its own; writes table.csv, table.md and summary.json. Variants that
/// have ended before are not run again with --resume. Status not_usable when one of them has a sample not at rest.
ExitStatus run_powder_variants(const Scene& scene, const CommonOptions& options);

}  // namespace softgrain
