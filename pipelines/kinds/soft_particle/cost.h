// What measuring soft particles takes: the time of a loop pass on this machine times the passes that relaxations took
// elsewhere.
#pragma once

#include "common/data/measurements.h"
#include "pipelines/kinds/soft_particle/scene.h"

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

}  // namespace softgrain
