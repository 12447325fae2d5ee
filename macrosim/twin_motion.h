// How a resolved twin is strained in motion.
#pragma once

#include "macrosim/macro_spec.h"
#include "macrosim/macro_system.h"

namespace softgrain {

/// Strains the box by the factors 1 - strain at the twin's speed, bodies carried along as a whole at first, and lets
/// all move on for the settling time; then nothing moves. It is left near its rest: a relaxation follows. The twin must
/// have dashpots. Throws UnusableResult (a grain is lost) and Interrupted.
void strain_in_motion(MacroSystem& macro, const MacroSpec& spec, const Vec3& strain);

}  // namespace softgrain
