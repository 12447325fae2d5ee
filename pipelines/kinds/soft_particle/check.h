// What measuring soft particles takes: the time of a loop pass on this machine times the passes that relaxations took
// elsewhere.
#pragma once

#include "common/data/measurements.h"
#include "pipelines/kinds/soft_particle/scene.h"
#include "pipelines/run/findings.h"

namespace softgrain {

/// A packing and a short run of the loop, one thread.
struct MeasureTrial {
  ShellPacking packing;
  double packing_seconds = 0.0;  ///< core seconds of the packing
  double pass_seconds = 0.0;     ///< per loop pass against a plane, halfway in
};

/// Takes the first packing of `seed`, and about `budget` seconds for the loop. Throws InputError when not a grain finds
/// a place.
MeasureTrial try_soft_particle(const SoftParticleSpec& spec, std::uint64_t seed, double budget);

/// Core seconds of all runs of one packing and one kind of pair along a plan, rotations included.
double measuring_seconds(const MeasureSetup& setup, Relaxation relaxation, const MeasurementPlan& plan, PairKind kind,
                         double pass_seconds);

// softgrain check of soft particles that are to be measured.

/// Counts, time step and who sets it, expected overlaps, memory and time, from one packing and a short trial of the
/// loop, which is returned. Adds "grains" and "solid_fraction" of that packing.
MeasureTrial check_measurements(const MeasureSetup& setup, Findings& out);

/// Warnings about the law of sizes and the material that hold for every scene with [material] and [packing].
void warn_of_soft_particle(const SoftParticleSpec& spec, Findings& out);

/// Largest overlap of grains over the smaller radius at an overlap Delta of the shell, as measured for the published
/// soft particle: 0.81 at Delta = 0.3 of a plane, 0.26 at 0.4 of an equal soft particle; in proportion to Delta.
double expected_grain_overlap(PairKind kind, double delta);

}  // namespace softgrain
