// What follows from a scene of kind "grain-box" before it runs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "pipelines/grain_box_setup.h"

namespace softgrain {

/// Adds facts per pack and the same as lines for people.
void check_grain_box(const GrainBoxSetup& setup, nlohmann::json& facts, std::string& lines);

}  // namespace softgrain
