// Whether a macro scene has room, asked before any work: periodic cells that are too small for their largest body, with
// the number of bodies that do, and memory.
#pragma once

#include <cstdint>
#include <string>

#include "common/io/scene.h"
#include "macrosim/macro_spec.h"
#include "pipelines/kinds/macro/scene.h"

namespace softgrain {

/// Bodies that are drawn before a run, of all samples of a scene.
inline constexpr double kMostDrawn = 2e7;

/// So many bodies of these sizes, whatever is drawn, that images of the largest stay two diameters apart in a periodic
/// cell while it is prepared (under the first pressure of its preparation) and strained by its test.
std::int64_t least_bodies(const MacroSpec& spec);

/// What is wrong with the samples that the run would draw, which cannot even be placed: "40 bodies are too few for a
/// periodic cell: ...: 130 or more have room". Empty: nothing. `what`: what bodies are called, in the plural.
std::string room_problem(const MacroSetup& setup, std::uint64_t seed, const std::string& what);

/// Says that samples of this or another seed may have no room left when they are pressed and strained. This is an
/// estimate and no reason to refuse them. Empty: no doubt. `what` as in room_problem().
std::string room_doubt(const MacroSetup& setup, std::uint64_t seed, const std::string& what);

/// A mistake at `key` of this table where the samples of a macro scene have no room; walls are offered instead.
void require_room_for_images(const SceneTable& macro, const char* key, const MacroSetup& setup, std::uint64_t seed);

// Whether a macro scene fits into memory, asked before any work.

/// What a scene of so many bodies, or a twin of so many grains, holds while it runs [bytes].
double macro_memory(double bodies);

/// Empty when the scene fits into `available` bytes (0: unknown, anything fits), one sample at a time; else the
/// sentence that says what it takes and how many bodies would fit. `grains`: in a soft particle of its twins.
std::string macro_memory_problem(const MacroSetup& setup, double grains, double available);

/// Refuses a scene that does not fit, at its key `bodies`. `content`: what its twins are filled with; packed on trial
/// where it matters. Throws InputError.
void require_macro_memory(const SceneTable& macro, const MacroSetup& setup, const SoftParticleSpec& content);

}  // namespace softgrain
