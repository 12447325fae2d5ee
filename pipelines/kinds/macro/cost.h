// What the runs of a macro scene take, from a short trial of its own law runs.
#pragma once

#include <vector>

#include "pipelines/kinds/macro/scene.h"
#include "pipelines/law/named_laws.h"
#include "pipelines/run/findings.h"

namespace softgrain {

/// What the scene holds, and what is inside its soft particles.
struct MacroContent {
  double bodies = 0.0;
  double soft = 0.0;
  double grains_per_soft = 0.0;
  double grain_pass_seconds = 0.0;  ///< of one core, per loop pass and grain; 0: no twin is run
  double solid_fraction = 0.0;      ///< 0: not known
  bool prepared = false;            ///< samples are those of another scene
};

/// Runs the scene, or one of the same kind with fewer bodies, by its laws for a moment (without laws by one like the
/// published) and adds what preparation, law runs and twins of all samples will take.
void spend_on_macro(const MacroSetup& setup, const MacroContent& content, const LawSources* laws, Findings& out);

}  // namespace softgrain
