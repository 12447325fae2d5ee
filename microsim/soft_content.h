// What a soft particle holds: grains, and soft particles of the level below.
#pragma once

#include <cstdint>
#include <vector>

#include "common/core/vec.h"
#include "common/data/shell_packing.h"

namespace softgrain {

/// A soft particle inside a soft particle.
struct InnerSoft {
  Vec3 x{};        ///< position from the centre of the shell that holds it, in units of that shell
  double r = 0.0;  ///< radius in the same units
};

struct SoftContent {
  ShellPacking grains;
  std::vector<InnerSoft> inner;              ///< soft particles of the next level, whose contacts follow a law
  std::vector<ShellPacking> inner_packings;  ///< unless their grains are here: inner soft particle k holds packing k,
                                             ///< turn by turn, in a shell that moves with the forces on it
};

/// The content turned as a whole about the centre of its shell: orientation 0 is as it is, every other one a rotation
/// drawn evenly from all of them, the same for the same seed, packing and orientation.
SoftContent turned(const SoftContent& content, std::uint64_t seed, std::int64_t packing, std::int64_t orientation);

}  // namespace softgrain
