// Scene kind "particles": explicit particles and walls from a file alone.
#pragma once

#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// Runs a scene of kind "particles"; writes run.h5 and summary.json, checkpoints on the way.
/// Status not_usable when a particle was lost or the motion diverged (both files are written and marked).
SceneKind particles_kind();

}  // namespace softgrain
