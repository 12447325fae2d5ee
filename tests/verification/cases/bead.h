// The steel beads of the chain cases.
#pragma once

#include "tests/verification/cases/closed_forms.h"
#include "tests/verification/cases/scene_text.h"

namespace softgrain::verification {

inline constexpr double kBeadRadius = 0.01;  ///< [m]
inline const SceneMaterial kSteel{"grain", 7800.0, 2.1e11, 0.3};

/// Two beads of kBeadRadius.
inline HertzPair bead_pair() {
  return {hertz_stiffness(effective_modulus(kSteel.youngs_modulus, kSteel.poisson_ratio), 0.5 * kBeadRadius),
          0.5 * sphere_mass(kBeadRadius, kSteel.density)};
}

}  // namespace softgrain::verification
