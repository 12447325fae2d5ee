// Spheres of given sizes in a rigid shell, denser than random trials place them: they grow while they push each other
// aside.
#pragma once

#include <vector>

#include "common/core/random.h"
#include "common/data/shell_packing.h"

namespace softgrain {

struct CompactedShell {
  ShellPacking packing;  ///< spheres in the order of the radii that were given; none overlaps another one or the shell
  double share = 1.0;    ///< share of the radii asked for that is reached; below 1 where the spheres jam before
};

/// Places spheres of these radii (over that of the shell, largest first) at random, small, and lets them grow by steps,
/// frictionless, each followed by a damped relaxation, until they have their radii or do not come free of overlap any
/// more. Depends on its arguments alone. Throws InputError when there is nothing to place or a radius is not below 1.
CompactedShell compact_in_shell(const std::vector<double>& radius, RandomStream& random);

}  // namespace softgrain
