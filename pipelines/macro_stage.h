// The macro part of a pipeline: samples with fitted laws, their resolved twins, and what they have in common.
#pragma once

#include <string>
#include <vector>

#include "common/data/law_card.h"
#include "common/data/macro_result.h"
#include "common/data/shell_packing.h"
#include "common/io/scene.h"
#include "macrosim/macro_spec.h"
#include "pipelines/run_context.h"
#include "pipelines/task_store.h"

namespace softgrain {

struct MacroSetup {
  MacroSpec spec;
  std::int64_t samples = 1;
  bool resolved = true;  ///< run the shelled twin of every sample
};

/// Reads [macro]; material defaults come from the measured soft particle. Throws BadInput.
MacroSetup read_macro_setup(const SceneTable& macro, const SoftParticleSpec& defaults);

/// Runs all samples with the laws of `card` and, when asked, their shelled twins filled with `contents`; saves
/// DIR/macro.h5 and DIR/macro_initial.h5 (the common starting states). Throws BadInput when the card has no usable law
/// for the scene.
std::vector<MacroCurve> run_macro_stage(const MacroSetup& setup, const LawCard& card,
                                        const std::vector<ShellPacking>& contents, std::uint64_t seed,
                                        const TaskStore& store, const RunContext& context,
                                        const Provenance& provenance);

}  // namespace softgrain
