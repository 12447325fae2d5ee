// Why a test may begin under less stress than its preparation ended with.
#pragma once

#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "macrosim/macro_spec.h"

namespace softgrain {

/// One sentence for every engine whose first recorded points bear, in the mean of its samples, less than half of
/// start_pressure E; the preparation itself meets it to a third.
std::vector<std::string> first_point_remarks(const MacroSpec& spec, const std::vector<MacroCurve>& curves);

}  // namespace softgrain
