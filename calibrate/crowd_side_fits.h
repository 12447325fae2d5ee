// What a crowd law needs besides normal loading: tangential stiffness, friction limit, unloading branch.
#pragma once

#include <vector>

#include "calibrate/crowd_states.h"
#include "common/contact/crowd_prediction.h"
#include "common/data/crowd_law.h"

namespace softgrain {

/// kt/kn (initial slope of the sliding force over the law's normal stiffness), mu_soft (largest tangential over normal
/// force) and s of the unloading branch, as means over the configurations of planes that slide or unload
/// and are not held out, errors from their
/// scatter. Without such configurations: kt/kn 0.3, mu_soft the friction of the grains, s = 1, all with infinite error.
void fit_sides(const std::vector<CrowdStates>& states, const CrowdModel& model, LawTableEntry& entry);

}  // namespace softgrain
