// softgrain check of soft particles that are to be measured.
#pragma once

#include "pipelines/kinds/soft_particle/cost.h"
#include "pipelines/run/findings.h"

namespace softgrain {

/// Counts, time step and who sets it, expected overlaps, memory and time, from one packing and a short trial of the
/// loop, which is returned. Adds "grains" and "solid_fraction" of that packing.
MeasureTrial check_measurements(const MeasureSetup& setup, Findings& out);

/// Warnings about the law of sizes and the material that hold for every scene with [material] and [packing].
void warn_of_soft_particle(const SoftParticleSpec& spec, Findings& out);

/// Largest overlap of grains over the smaller radius at an overlap Delta of the shell, as measured for the published
/// soft particle: 0.81 at Delta = 0.3 of a plane, 0.26 at 0.4 of an equal soft particle; in proportion to Delta.
double expected_grain_overlap(PairKind kind, double delta);

}  // namespace softgrain
