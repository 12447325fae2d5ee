// How forces are distributed in a powder [CP 3.5].
#pragma once

#include <optional>
#include <vector>

#include "microsim/powder/histogram.h"
#include "microsim/powder/powder_interactions.h"

namespace softgrain {

/// In the units of the sample (F0, or P a without cohesion); bins are the same for every sample, so that counts add up.
struct PowderForces {
  Histogram normal{-1.1, 6.1, 144};            ///< N of all pairs, distant ones too
  Histogram normal_over_mean{-2.0, 8.0, 100};  ///< N over its mean, of the same; empty unless that is above the limit
  Histogram ratio{0.0, 5.0, 100};   ///< |T/N| of stressed contacts; |T/N| = sqrt 3 where a disk leans on two that touch
  Histogram angle{0.0, 180.0, 36};  ///< between n and F of stressed contacts [degrees]: 0 pressed, 180 pulled
  std::optional<double> zero_share;  ///< share of contacts (distant pairs left out) with |F| below `zero`
};

/// `zero`: as in powder_interactions.
PowderForces powder_forces(const std::vector<PowderInteraction>& pairs, double zero);

}  // namespace softgrain
