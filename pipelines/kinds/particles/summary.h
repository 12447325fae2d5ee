// The summary of a run of explicit particles, for programs and for people.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "microsim/particles/particles_run.h"

namespace softgrain {

/// Everything but provenance and files: state, contacts, cost. `memory_before`: peak of the process before the scene
/// was read [bytes].
template <int D>
nlohmann::json particles_summary(const ParticlesSceneOf<D>& scene, const ParticlesResultOf<D>& result,
                                 double memory_before);

/// A line or two.
template <int D>
std::string particles_text(const ParticlesResultOf<D>& result);

}  // namespace softgrain
