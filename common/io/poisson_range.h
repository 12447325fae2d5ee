// The range of Poisson's ratio as readers of keys take it.
#pragma once

#include "common/core/poisson_ratio.h"
#include "common/io/scene.h"

namespace softgrain {

inline constexpr Range kPoissonRange{kPoissonAbove, kPoissonHighest, true, false};

}  // namespace softgrain
