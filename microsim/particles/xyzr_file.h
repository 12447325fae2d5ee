// Files of many spheres: "N Lx Ly Lz" on the first line, then N lines "x y z r". Plain or compressed by gzip. SI units.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/core/vec.h"

namespace softgrain {

struct XyzrFile {
  Vec3 box{};                  ///< Lx Ly Lz [m], as written
  std::vector<Vec3> position;  ///< [m]
  std::vector<double> radius;  ///< [m], > 0
};

/// Line of a sphere in its file.
inline std::int64_t xyzr_line(std::size_t sphere) { return static_cast<std::int64_t>(sphere) + 2; }

/// Throws InputError ("file:line: ...") for wrong content, IoError for missing, unreadable or damaged files. `admit`
/// hears the number of spheres before they are read and throws when that is too many; may be empty.
XyzrFile read_xyzr(const std::string& path, const std::function<void(std::int64_t)>& admit = {});

}  // namespace softgrain
