// What the runs of a macro scene take, from a short trial of its own law runs.
#pragma once

#include <cstdint>
#include <vector>

#include "pipelines/kinds/macro/scene.h"
#include "pipelines/law/named_laws.h"
#include "pipelines/run/findings.h"

namespace softgrain {

/// What the scene holds, and what is inside its soft particles.
struct MacroContent {
  double bodies = 0.0;  ///< bodies in a sample, mean
  double soft = 0.0;
  double grains_per_soft = 0.0;        ///< mean over contents
  std::vector<std::int64_t> grains{};  ///< grains in each content, in order; fewer entries where counting took too long
  double smallest_grain = 0.0;         ///< radius of the smallest grain over that of its shell; 0: not known
  std::int64_t contents = 0;           ///< different ones; soft particle k holds number k modulo this
  double grain_pass_seconds = 0.0;     ///< core seconds per loop pass and grain; 0: no twin is run
  double solid_fraction = 0.0;         ///< 0: not known
  bool prepared = false;               ///< samples are those of another scene
  bool untimed = false;                ///< somebody else tells the time
};

/// Runs the scene, or one of the same kind with fewer bodies, by its laws for a moment (without laws by one like the
/// published) and adds what preparation, law runs and twins of all samples will take.
void spend_on_macro(const MacroSetup& setup, const MacroContent& content, const LawSources* laws, std::uint64_t seed,
                    Findings& out);

}  // namespace softgrain
