// The summary of grain-box runs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "microsim/grain_box/record.h"

namespace softgrain {

/// One object per pack: states at the ends of the phases, moduli at round stresses, growth exponents, effort.
nlohmann::json grain_boxes_json(const std::vector<GrainBoxResult>& results);

/// K, G and sliding shares over the arrangements of every pack; empty where each has one.
nlohmann::json arrangements_json(const std::vector<GrainBoxResult>& results);

/// Sentences about what must not be overlooked: packs that broke off, increments that were tried again.
std::vector<std::string> grain_box_remarks(const std::vector<GrainBoxResult>& results);

}  // namespace softgrain
