// Where the first neighbour of a multi-contact measurement slides.
#pragma once

#include <cmath>

#include "common/core/vec.h"

namespace softgrain {

/// The unit vector along which the first neighbour slides: the coordinate axis least aligned with `direction` (the
/// first of equals), made perpendicular to it. +x slides along +y.
inline Vec3 slide_direction(const Vec3& direction) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(direction[k]) < std::abs(direction[axis])) axis = k;
  Vec3 along{};
  along[axis] = 1.0;
  along -= direction * dot(along, direction);
  return along * (1.0 / norm(along));
}

}  // namespace softgrain
