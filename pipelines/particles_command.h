// Scene kind "particles": explicit particles and walls from a file alone.
#pragma once

#include "common/io/scene.h"
#include "pipelines/run_context.h"

namespace softgrain {

/// Runs a scene of kind "particles"; writes run.h5 and summary.json, checkpoints on the way.
/// Status not_usable when a particle was lost or the motion diverged (both files are written and marked).
ExitStatus run_particles_scene(const Scene& scene, const CommonOptions& options);

}  // namespace softgrain
