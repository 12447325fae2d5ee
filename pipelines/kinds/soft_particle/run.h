// Scene kind "soft-particle": pack, measure, save; no fit.
#pragma once

#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// Runs a scene of kind "soft-particle"; writes measurements.h5, summary.json and report.html.
/// Status not_usable when a recorded point did not converge under its own criterion.
SceneKind soft_particle_kind();

}  // namespace softgrain
