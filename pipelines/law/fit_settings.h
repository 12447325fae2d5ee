#pragma once

#include "calibrate/threshold_fit.h"
#include "common/io/scene.h"

namespace softgrain {

/// Settings of a fit: table [calibrate] of a pipeline, and those of softgrain calibrate, for measurements of the
/// program and of an experiment alike. The caller finishes the table.
FitOptions read_fit_settings(const SceneTable& table);

}  // namespace softgrain
