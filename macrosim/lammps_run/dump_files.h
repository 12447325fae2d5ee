// Bodies and contacts as LAMMPS dumps them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "macrosim/macro_packing.h"

namespace softgrain::lammps {

struct DumpedBodies {
  Vec3 low{};  ///< corners of the box [m]
  Vec3 high{};
  std::vector<Vec3> x;  ///< centres of the bodies, in the order of the packing [m]
};

/// One force-carrying contact.
struct DumpedContact {
  std::int32_t i = 0;  ///< body
  std::int32_t j = 0;  ///< body, or bodies + number of the wall
  double normal_force = 0.0;
  Vec3 force{};   ///< force on i [N]
  Vec3 branch{};  ///< x_i - x_j; from a wall along its normal [m]
};

/// Bodies of `packing`, all of them and each once, radii unchanged. Throws IoError.
DumpedBodies read_bodies(const std::string& path, const MacroPacking& packing);

/// Contacts sorted by i, then j, with i < j. Throws IoError, also unless there are `count` contacts whose normal forces
/// sum up to `force_sum`, as the row of the point says.
std::vector<DumpedContact> read_contacts(const std::string& path, std::int32_t bodies, double count, double force_sum);

}  // namespace softgrain::lammps
