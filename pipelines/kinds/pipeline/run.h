// Scene kind "pipeline": pack, measure, fit, macro, resolved twin, compare.
#pragma once

#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// Writes measurements.h5, law.toml, law.h5, macro.h5, macro_initial.h5, summary.json and the report. Status not_usable
/// when points did not converge, a law is not good, or a curve is not usable.
SceneKind pipeline_kind();

}  // namespace softgrain
