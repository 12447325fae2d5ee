// Scene kind "soft-particle": pack, measure, save; no fit.
#pragma once

#include "common/io/scene.h"
#include "pipelines/run_context.h"

namespace softgrain {

/// Runs a scene of kind "soft-particle"; writes measurements.h5, summary.json and report.html.
/// Status not_usable when a recorded point did not converge under its own criterion.
ExitStatus run_soft_particle_scene(const Scene& scene, const CommonOptions& options);

}  // namespace softgrain
