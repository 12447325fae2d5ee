// A macro scene, with laws or resolved, as a picture of its state.
#pragma once

#include "common/data/snapshot.h"
#include "macrosim/macro_system.h"

namespace softgrain {

/// Solid grains, soft particles (of laws) or the grains inside them (of twins), each with the number of its body in the
/// packing; shells and planes as walls. Label, series, frame and strain are for the caller. Changes nothing.
Snapshot macro_snapshot(const MacroSystem& macro, const MacroPacking& packing);

}  // namespace softgrain
