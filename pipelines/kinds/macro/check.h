// softgrain check of macro scenes: what they are made of, what their runs take (from a short trial of their own law
// runs), and what they will ask of their laws.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/macro/stage.h"
#include "pipelines/kinds/soft_particle/check.h"
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

/// A kind = "macro" scene, and what it asks of its law if it has one. Throws InputError, IoError.
void check_macro_scene(const MacroScene& macro, Findings& out);

/// What the first `count` packings of a seed bring into the soft particles of a scene, the first of them tried already;
/// all are made unless that takes more than a moment.
MacroContent content_of(const MeasureTrial& trial, const SoftParticleSpec& spec, std::int64_t count,
                        std::uint64_t seed);
MacroContent content_of(const SoftParticleSpec& spec, std::int64_t count, std::uint64_t seed);

/// Bodies, twins, memory, time. `content`: of soft particles (bodies are counted here, from those that the run draws
/// with this seed). `laws`: what acts between soft particles; null: not known yet (a pipeline fits them).
void check_macro(const MacroSetup& setup, MacroContent content, const LawSources* laws, std::uint64_t seed,
                 Findings& out);

/// Overlaps of contacts of equal bodies at the end of a test if all moved with the box: h/R = 2 eps along the load and
/// two thirds of that (oedometric: a third) in the mean over all directions.
struct AffineOverlap {
  double mean = 0.0;
  double largest = 0.0;
};
AffineOverlap affine_overlap(const MacroSpec& spec);

}  // namespace softgrain
