// Prescribed displacements, without time.
#pragma once

#include <vector>

#include "common/system.h"

namespace softgrain {

/// Moves every body by its entry of `moves` [m] in one stroke and lets the tangential springs follow (history is
/// committed). Velocities are zero afterwards. Contact laws must be without damping.
template <int D>
void displace(System<D>& system, const std::vector<Vec<D>>& moves);

/// Moves every body as displace() above does, while the edges of a periodic rectangular cell grow by the factors 1 +
/// growth. A contact across a face sees the image move with it.
template <int D>
void displace(System<D>& system, const std::vector<Vec<D>>& moves, const Vec<D>& growth);

}  // namespace softgrain
