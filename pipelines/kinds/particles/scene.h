// A scene of kind "particles": what runs it, and what follows from it before.
#pragma once

#include "microsim/particles/particles_scene.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/run/findings.h"
#include "pipelines/run/scene_kind.h"
#include "pipelines/run/size_summary.h"

namespace softgrain {

/// Particles that were drawn by a distribution of sizes.
template <int D>
std::vector<DrawnSizes> drawn_sizes(const ParticlesSceneOf<D>& scene) {
  if (!scene.sizes) return {};
  return {{.of = "particles", .asked = *scene.sizes, .samples = {scene.drawn}}};
}

/// Counts, solid fraction of periodic cells, time step and what limits it, contacts and their overlaps at the start,
/// memory, disk, expected time from a short trial of the loop; and what to mind.
template <int D>
void check_particles(const ParticlesSceneOf<D>& scene, Findings& out);

/// Runs a scene of kind "particles"; writes run.h5 and summary.json, checkpoints on the way.
/// Status not_usable when a particle was lost or the motion diverged (both files are written and marked).
SceneKind particles_kind();

// What runs of explicit particles leave behind.

KindResults particles_results();

/// run.h5: every recorded frame, with the contacts of those that kept them; frames whose numbers were lost are left
/// out. Throws IoError.
void visit_particles(const std::string& path, SnapshotChoice choice, const VisitSnapshot& visit);

namespace report {
std::string energies_section(const RunData& run);   ///< energies of the recorded frames over time
std::string stresses_section(const RunData& run);   ///< stress and inertial number over time, of periodic cells
std::string particles_section(const RunData& run);  ///< final states and contacts
}  // namespace report

}  // namespace softgrain
