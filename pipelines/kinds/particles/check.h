// What follows from a scene of kind "particles" before it runs.
#pragma once

#include "microsim/particles/particles_scene.h"
#include "pipelines/run/findings.h"

namespace softgrain {

/// Counts, solid fraction of periodic cells, time step and what limits it, contacts and their overlaps at the start,
/// memory, disk, expected time from a short trial of the loop; and what to mind.
template <int D>
void check_particles(const ParticlesSceneOf<D>& scene, Findings& out);

}  // namespace softgrain
