// Scene kind "particles": explicit particles, walls, gravity, a cell, in space or (disks) in the plane.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/io/scene.h"
#include "common/packing/grading.h"
#include "common/system.h"
#include "microsim/particles/guards.h"
#include "microsim/particles/scene_bodies.h"
#include "microsim/particles/scene_time.h"

namespace softgrain {

/// A scene ready to run.
template <int D>
struct ParticlesSceneOf {
  std::string title;
  System<D> system;                    ///< bodies in their first positions, nothing evaluated yet
  std::vector<std::string> wall_name;  ///< names of the walls, by slot from particles.grains on
  SceneTime time;
  bool record = true;                 ///< false: no frames, no watched contacts, no file of the run; the summary alone
  std::int64_t output_stride = 0;     ///< steps between recorded frames; 0: only the first and the last state
  std::int64_t snapshots = 0;         ///< recorded frames that keep their contacts, evenly spread
  std::int64_t checkpoint_steps = 0;  ///< 0: by wall time alone
  double checkpoint_seconds = 300.0;  ///< wall time between checkpoints [s]
  GuardSpec guards;
  std::string text;                  ///< the scene as it is used
  std::string law_files;             ///< text of the law cards and tables that it takes laws from, and of sizes
  std::optional<Grading> sizes;      ///< size distribution of the particles that were drawn
  std::vector<double> drawn;         ///< radii of the particles that were drawn
  std::uint64_t seed = 0;            ///< seed with which the particles were drawn
  std::vector<std::string> remarks;  ///< what to mind about laws, times and places of this scene

  /// Number of frames of a run that comes to its end: the first and the last state, and those in between.
  [[nodiscard]] std::int64_t frames() const { return 2 + (output_stride > 0 ? (time.steps - 1) / output_stride : 0); }
};

using ParticlesScene = ParticlesSceneOf<3>;

/// Key `dimension`: 3 unless the scene says 2. Throws InputError.
int particles_dimension(const Scene& scene);

/// Reads and checks everything, computes the step. `D` is the dimension of the scene. Throws InputError with file:line
/// (also for particles that lie in a file of their own), IoError for files that cannot be read.
/// `seed`: of what is drawn, in place of that of the scene.
template <int D = 3>
ParticlesSceneOf<D> read_particles_scene(const Scene& scene, const std::optional<std::uint64_t>& seed = {});

// Where the particles of a scene are at its start: particles that no wall or cell holds are found before anything runs.

/// Throws InputError with file:line for a particle whose centre is behind a plane or outside the room of guards.escape,
/// where that guard would stop the run at its first look; where the guard only counts, this is a remark. Remarks also
/// name particles outside of all insides of spheres (unless they say inside = "none") and centres outside a cell along
/// an axis that is not periodic. `has_cell`: the scene says a cell. Each remark names the first particle and their
/// number.
template <int D>
std::vector<std::string> place_remarks(const SceneBodies<D>& bodies, const System<D>& system,
                                       const std::vector<std::string>& wall_name, const GuardSpec& guards,
                                       bool has_cell);

}  // namespace softgrain
