// Scene kind "cohesive-powder": disks with adhesion in two dimensions, assembled until they rest.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "pipelines/kinds/cohesive_powder/scene.h"
#include "pipelines/run/findings.h"
#include "pipelines/run/run_context.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// Runs all samples; writes powder.h5 (final states and the course of each assembly) and summary.json. Status
/// not_usable when a sample did not come to rest: the summary says which criterion was unmet.
ExitStatus run_powder_ensemble(const PowderSetup& setup, const Scene& scene, const RunContext& context);

/// The same from a scene, or each of its variants.
SceneKind cohesive_powder_kind();

/// What follows from such a scene: phases, time step, steps at most, overlaps, time from a short trial.
void check_powder(const Scene& scene, Findings& out);

}  // namespace softgrain
