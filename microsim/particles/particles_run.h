// Runs a scene of explicit particles by velocity Verlet: frames, contacts, checkpoints.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/io/provenance.h"
#include "microsim/particles/contact_monitor.h"
#include "microsim/particles/guards.h"
#include "microsim/particles/particles_scene.h"
#include "microsim/particles/trajectory.h"

namespace softgrain {

/// What the caller provides.
struct ParticlesControl {
  std::string checkpoint;                           ///< path; empty: none is written or read
  bool resume = false;                              ///< go on from the checkpoint when there is one
  std::function<void(const std::string&)> say;      ///< a line for people; may be empty
  std::function<void(std::int64_t step)> progress;  ///< now and then; may be empty
};

/// Systems up to this size have their contacts watched.
inline constexpr Slot kMostWatched = 1000;

/// Cost of a stretch of steps in this process alone: nothing is carried over from a checkpoint.
struct LoopPart {
  std::int64_t steps = 0;
  double seconds = 0.0;      ///< wall time of the stepping loop, without reading, first forces and writing
  double cpu_seconds = 0.0;  ///< processor time of all threads in it: what it would take on an idle machine
  std::int64_t contact_evaluations = 0;
  std::int64_t rebuilds = 0;  ///< rebuilds of the neighbour list
};

template <int D>
struct ParticlesResultOf {
  System<D> system;  ///< final state
  Trajectory trajectory;
  FrameContacts frame_contacts;
  bool watched = false;                  ///< contacts were watched
  std::vector<ContactHistory> contacts;  ///< histories of every pair that touched
  bool usable = false;
  std::string reason;  ///< why not: lost or diverged particle, with step and time
  GuardReport guards;
  LoopPart warm_up;          ///< the first SceneTime::warm_up_steps
  LoopPart measured;         ///< the steps after the warm-up; empty for a run that was lost
  double peak_memory = 0.0;  ///< peak memory of the process at the end of the loop [bytes]; 0 when unknown
};

using ParticlesResult = ParticlesResultOf<3>;

/// What a run is of beside the text of its scene: particles, cell and laws, which may lie in files of their own.
/// `start`: the system before the first step. Hashed piece by piece: large scenes are not in memory twice.
template <int D>
std::string content_of(const ParticlesSceneOf<D>& scene, const System<D>& start);

/// A particle that counts as lost: a number of its motion is not finite, or it moves its own radius or more in a step
/// and would pass through others unseen. -1: none.
template <int D>
Slot lost_particle(const System<D>& system, double step);

/// Runs to the end of the scene's time. The trajectory does not depend on output, checkpoints, threads or
/// interruptions. Throws Interrupted after writing the checkpoint when a signal came; InputError, IoError for the
/// checkpoint.
template <int D>
ParticlesResultOf<D> run_particles(const ParticlesSceneOf<D>& scene, const ParticlesControl& control);

/// Runs the scene from a state that is handed over, so that large scenes are not in memory twice.
template <int D>
ParticlesResultOf<D> run_particles(const ParticlesSceneOf<D>& scene, System<D> start, const ParticlesControl& control);

/// run.h5: provenance, bodies, trajectory, contacts of some frames and over the whole run, and the final state in full.
/// Atomic. Throws IoError.
template <int D>
void save_particles_run(const std::string& path, const ParticlesSceneOf<D>& scene, const ParticlesResultOf<D>& result,
                        const Provenance& provenance);

}  // namespace softgrain
