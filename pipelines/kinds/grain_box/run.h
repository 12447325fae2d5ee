// Scene kind "grain-box": quasi-static moduli of packs of grains between six planes.
#pragma once

#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// Runs a scene of kind "grain-box"; writes grain_box.h5, summary.json and report.html. Packs run side by side when
/// there are threads for it. Status not_usable when a pack could not be brought to its end (what came before is kept).
SceneKind grain_box_kind();

}  // namespace softgrain
