// softgrain check of macro scenes: what they are made of, and what they will ask of their laws.
#pragma once

#include <string>

#include "pipelines/kinds/macro/cost.h"
#include "pipelines/kinds/macro/stage.h"
#include "pipelines/kinds/soft_particle/cost.h"
#include "pipelines/run/findings.h"

namespace softgrain {

/// A kind = "macro" scene; `law` replaces its key of that name, and the law is opened when there is one. Throws
/// InputError, IoError.
void check_macro_scene(const Scene& scene, const std::string& law, Findings& out);

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
