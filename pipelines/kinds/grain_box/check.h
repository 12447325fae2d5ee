// What follows from a scene of kind "grain-box" before it runs.
#pragma once

#include "pipelines/kinds/grain_box/scene.h"
#include "pipelines/run/findings.h"

namespace softgrain {

/// Facts per pack: counts, solid fraction, overlap at the end of the loading, memory, time; and what to mind.
void check_grain_box(const GrainBoxSetup& setup, Findings& out);

}  // namespace softgrain
