// Periodic cells that are too small for their largest body: found before the run, with the number of bodies that do.
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

}  // namespace softgrain
