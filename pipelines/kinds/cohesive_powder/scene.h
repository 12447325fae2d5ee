// Tables of a scene of kind "cohesive-powder".
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "common/io/scene.h"
#include "microsim/powder/powder_assembly.h"
#include "pipelines/kinds/cohesive_powder/structure.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/run/findings.h"
#include "pipelines/run/run.h"
#include "pipelines/run/scene_kind.h"
#include "pipelines/run/size_summary.h"

namespace softgrain {

struct PowderSetup {
  std::string title;
  PowderSpec spec;
  PowderOptions options;
  PowderStructureOptions structure;
  PowderProtocol protocol;
  std::int64_t samples = 1;
  std::uint64_t seed = 1;
  std::string states;    ///< powder.h5 of an earlier run: its states are analysed instead of new ones assembled
  bool rigidity = true;  ///< whether the rigidity matrix is factorised at the end

  [[nodiscard]] std::vector<PowderPhase> phases() const { return powder_phases(spec, protocol); }
  /// Time step of the smallest disk that may be drawn [T0].
  [[nodiscard]] double time_step() const { return options.step * spec.diameter_min / std::sqrt(spec.stiffness); }
  /// Largest stress that any phase imposes.
  [[nodiscard]] double largest_stress() const;
};

/// What determines a run beside its scene and seed: sizes, the meaning of V0, and states that are analysed. A run that
/// began with V0 of |v| does not go on.
std::string powder_text(const PowderSetup& setup);

/// Disks whose sizes a distribution says.
std::vector<DrawnSizes> drawn_sizes(const PowderSetup& setup, std::uint64_t seed);

/// Reads the scene to the last key. Throws InputError; IoError when there are no `states` to be read.
PowderSetup read_powder(const Scene& scene);

/// Runs all samples; writes powder.h5 (final states and the course of each assembly) and summary.json. Status
/// not_usable when a sample did not reach equilibrium: the summary says which criterion was unmet.
ExitStatus run_powder_ensemble(const PowderSetup& setup, const Run& run);

/// Scene kind "cohesive-powder": runs the ensemble of a scene, or of each of its variants.
SceneKind cohesive_powder_kind();

/// What follows from such a scene: phases, time step, steps at most, overlaps, time from a short trial.
void check_powder(const Scene& scene, Findings& out);

// What runs of cohesive powders leave behind.

KindResults powder_results();

/// powder.h5: pictures of the assembly without contacts, then the state that it ended in, with them. Throws
/// IoError.
void visit_powder(const std::string& path, SnapshotChoice choice, const VisitSnapshot& visit);

namespace report {
std::string powder_section(const RunData& run);           ///< packings, forces, I(k), courses
std::string powder_variants_section(const RunData& run);  ///< all variants beside what is published
}  // namespace report

}  // namespace softgrain
