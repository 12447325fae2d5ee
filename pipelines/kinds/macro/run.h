// Scene kind "macro": one macro scene with a law card or a law table, and its resolved twins when it asks for them.
#pragma once

#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// Runs all samples by law, in our engine or in LAMMPS, and the twins; writes macro.h5, macro_initial.h5, the kept
/// states, summary.json and the report. Status not_usable when a curve is not usable or carries no stress.
SceneKind macro_kind();

}  // namespace softgrain
