#pragma once

#include "calibrate/threshold_fit.h"
#include "common/io/scene.h"

namespace softgrain {

/// Settings of a fit, the same for measurements of the program and of an experiment. The caller finishes the table.
FitOptions read_fit_settings(const SceneTable& table);

}  // namespace softgrain
