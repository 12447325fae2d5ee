// Scene kind "grain-box": quasi-static moduli of packs of grains between six planes.
#pragma once

#include "common/io/scene.h"
#include "pipelines/run_context.h"

namespace softgrain {

/// Runs a scene of kind "grain-box"; writes grain_box.h5, summary.json and report.html. Packs run side by side when
/// there are threads for it. Status not_usable when a pack could not be brought to its end (what came before is kept).
ExitStatus run_grain_box_scene(const Scene& scene, const CommonOptions& options);

}  // namespace softgrain
