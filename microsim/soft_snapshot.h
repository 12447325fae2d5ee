// A measurement as a picture of its state.
#pragma once

#include "common/data/snapshot.h"
#include "microsim/soft_experiment.h"

namespace softgrain {

/// Grains with the soft particle they are inside (body 0, and 1 of a pair), shells as walls with their body, the plane
/// with none. Label, series and frame are for the caller. Changes nothing.
Snapshot soft_snapshot(const SoftExperiment& experiment);

}  // namespace softgrain
