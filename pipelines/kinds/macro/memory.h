// Whether a macro scene fits into memory, asked before any work.
#pragma once

#include <string>

#include "common/io/scene.h"
#include "pipelines/kinds/macro/scene.h"

namespace softgrain {

/// What a scene of so many bodies, or a twin of so many grains, holds while it runs [bytes].
double macro_memory(double bodies);

/// Empty when the scene fits into `available` bytes (0: unknown, anything fits), one sample at a time; else the
/// sentence that says what it takes and how many bodies would fit. `grains`: in a soft particle of its twins.
std::string macro_memory_problem(const MacroSetup& setup, double grains, double available);

/// Refuses a scene that does not fit, at its key `bodies`. `content`: what its twins are filled with; packed on trial
/// where it matters. Throws InputError.
void require_macro_memory(const SceneTable& macro, const MacroSetup& setup, const SoftParticleSpec& content);

}  // namespace softgrain
