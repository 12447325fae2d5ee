// What follows from a scene of kind "grain-box" before it runs.
#pragma once

#include "pipelines/findings.h"
#include "pipelines/grain_box_setup.h"

namespace softgrain {

/// Facts per pack: counts, solid fraction, overlap at the end of the loading, memory, time; and what to mind.
void check_grain_box(const GrainBoxSetup& setup, Findings& out);

}  // namespace softgrain
