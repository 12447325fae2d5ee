// The macro part of a pipeline: samples with laws, their resolved twins, and what they have in common.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "common/data/shell_packing.h"
#include "common/data/snapshot.h"
#include "common/io/scene.h"
#include "macrosim/macro_packing.h"
#include "macrosim/macro_spec.h"
#include "macrosim/macro_system.h"
#include "pipelines/named_laws.h"
#include "pipelines/run_context.h"
#include "pipelines/task_store.h"

namespace softgrain {

struct MacroSetup {
  MacroSpec spec;
  std::int64_t samples = 1;
  std::vector<std::string> twins{"shelled"};  ///< of "shelled", "free": resolved beside every sample
  std::int64_t kept_states = 0;               ///< of the first sample of every engine, for pictures
  std::vector<std::string> assumed{};         ///< "nu = 0.3": of grains, where the law does not say them
};

[[nodiscard]] inline bool has_twin(const MacroSetup& setup, const std::string& name) {
  return std::find(setup.twins.begin(), setup.twins.end(), name) != setup.twins.end();
}

/// Reads [macro]; material defaults come from the measured soft particle, as far as it is known. Throws BadInput.
MacroSetup read_macro_setup(const SceneTable& macro, const SoftParticleSpec& defaults);

/// Replaces what a table says, keeps the rest. Throws BadInput.
MacroSetup read_macro_setup(const SceneTable& macro, const MacroSetup& base);

/// Twins are filled with packings like the one that was measured. Throws BadInput, at key `resolved`, when the scene
/// has twins and `spec` of the law in this file does not say what is inside.
void require_known_contents(const SceneTable& macro, const MacroSetup& setup, const SoftParticleSpec& spec,
                            const std::string& law_file);

/// What was assumed because the law does not say it, as a sentence; empty when nothing was.
std::string assumed_text(const MacroSetup& setup);

/// For commands that do not run LAMMPS. Throws BadInput.
void require_own_preparation(const SceneTable& macro, const MacroSetup& setup);

/// Packings number 0 .. count-1 of a seed, to fill soft particles with.
std::vector<ShellPacking> make_contents(const SoftParticleSpec& spec, std::int64_t count, std::uint64_t seed);

/// The starting states of all samples, the same for all engines (with preparation "lammps": where bodies are placed
/// before it); they are kept in the store until the run has ended, under the name of `file` without its extension.
std::vector<MacroPacking> prepare_packings(const MacroSetup& setup, std::uint64_t seed, const TaskStore& store,
                                           const RunContext& context, const std::string& file);

/// Writes them to DIR/`file`.
void save_packings(const std::vector<MacroPacking>& packings, const RunContext& context, const Provenance& provenance,
                   const std::string& file);

/// Both.
std::vector<MacroPacking> make_macro_packings(const MacroSetup& setup, std::uint64_t seed, const TaskStore& store,
                                              const RunContext& context, const Provenance& provenance,
                                              const std::string& file);

/// Of the contents, their mean; 1 without any.
double mean_solid_fraction(const std::vector<ShellPacking>& contents);

/// One scene with all its engines.
struct MacroRuns {
  const MacroSetup& setup;
  const std::vector<MacroPacking>& packings;  ///< one per sample
  const std::vector<ShellPacking>& contents;  ///< of soft particles
  std::uint64_t seed = 1;
  std::string name;  ///< of checkpoints and of progress: "macro", or that of the scene
};

/// A run and the states of it that are kept.
struct RunOutcome {
  MacroCurve curve;
  std::vector<Snapshot> states;
};

/// The state at the end of a curve, with the names that people and files give it; `runs`: as MacroRuns::name.
Snapshot named_state(const MacroSystem& macro, const MacroPacking& packing, const MacroCurve& curve,
                     const std::string& runs);

/// Every law, then every twin, each on all samples; goes on from checkpoints of recorded points. States that are kept
/// for pictures go to DIR/`states_file`. `before`: runs of another engine, whose curves and states come first.
std::vector<MacroCurve> run_engines(const MacroRuns& runs, const std::vector<NamedLaws>& laws, const TaskStore& store,
                                    const RunContext& context, const Provenance& provenance,
                                    const std::string& states_file, std::vector<RunOutcome> before = {});

/// Runs all samples with `law` and the twins asked for, filled with `contents`; saves DIR/macro.h5,
/// DIR/macro_initial.h5 (the common starting states) and DIR/states_macro.h5.
std::vector<MacroCurve> run_macro_stage(const MacroSetup& setup, const NamedLaws& law,
                                        const std::vector<ShellPacking>& contents, std::uint64_t seed,
                                        const TaskStore& store, const RunContext& context,
                                        const Provenance& provenance);

}  // namespace softgrain
