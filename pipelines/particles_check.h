// What follows from a scene of kind "particles" before it runs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "microsim/particles/particles_scene.h"

namespace softgrain {

/// Adds facts and the same as lines for people: counts, time step and what limits it, contacts, memory, expected time
/// from a short trial of the loop.
void check_particles(const ParticlesScene& scene, nlohmann::json& facts, std::string& lines);

}  // namespace softgrain
