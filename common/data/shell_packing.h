// Grains inside a unit shell: what the packing generator makes, measurements start from and resolved twins are filled
// with.
#pragma once

#include <cstdint>
#include <vector>

#include "common/core/vec.h"

namespace softgrain {

/// Dimensionless: shell of radius 1 centred at the origin; grains largest first.
struct ShellPacking {
  std::uint64_t seed = 0;  ///< number of the packing in its run
  std::vector<Vec3> position;
  std::vector<double> radius;

  /// Volume of grains over volume of the shell.
  [[nodiscard]] double solid_fraction() const {
    double sum = 0.0;
    for (const double r : radius) sum += r * r * r;
    return sum;
  }
};

}  // namespace softgrain
