// What LAMMPS leaves: bodies and contacts in its dumps, the end of its log.
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

// The end of a log of LAMMPS, when something went wrong.

struct LogTail {
  std::string text;

  [[nodiscard]] bool says(const std::string& words) const { return text.find(words) != std::string::npos; }
  /// The first line with "ERROR", else the last lines; on one line.
  [[nodiscard]] std::string complaint() const;
};

/// What stands beyond `begin`, at most the last 64 kB of it.
LogTail read_log(const std::string& path, std::uintmax_t begin);

}  // namespace softgrain::lammps
