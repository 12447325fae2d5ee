// What holds the axes of a box: their lengths, or stresses.
#pragma once

#include <array>
#include <cmath>

#include "common/core/vec.h"

namespace softgrain {

/// What each axis of a box is held by.
struct BoxControl {
  std::array<bool, 3> by_stress{};  ///< else its length stays
  Vec3 stress{};                    ///< stress on the axes held by stress, compression positive [Pa]
  bool isotropic = false;           ///< all axes strain alike, by the mean of their stresses
  double tolerance = 1e-3;          ///< tolerance of the stress, over the largest one asked for
  double least_stress = 0.0;        ///< lower limit of that largest stress in the tolerance [Pa]
  double largest_strain = 2e-3;     ///< per pass
  double farthest = HUGE_VAL;       ///< logarithmic strain in all at which the stress is given up as out of reach

  /// Whether an axis is held by no stress at all.
  [[nodiscard]] bool free(int axis) const { return by_stress[static_cast<std::size_t>(axis)] && stress[axis] == 0.0; }
};

}  // namespace softgrain
