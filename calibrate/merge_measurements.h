// Several measurement files as one ensemble.
#pragma once

#include <string>
#include <vector>

#include "common/data/measurements.h"

namespace softgrain {

/// Joins packings and runs; indices of packings are shifted. `names` (one per part) stand for the parts in messages.
/// Throws InputError when there is nothing to merge, when a part was measured on another soft particle or by another
/// protocol (first differing quantity named, with both values), or when the same packing was measured twice by the same
/// relaxation.
Measurements merge_measurements(const std::vector<Measurements>& parts, const std::vector<std::string>& names);

}  // namespace softgrain
