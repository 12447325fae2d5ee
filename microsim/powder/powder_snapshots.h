// Where the disks of a powder were at moments of its assembly: what a picture needs, no more.
#pragma once

#include <vector>

#include "common/io/hdf5_file.h"
#include "common/system.h"

namespace softgrain {

struct PowderSnapshot {
  double time = 0.0;             ///< [T0]
  Vec<2> lengths{};              ///< of the periodic cell [a]
  std::vector<Sphere<2>> disks;  ///< centres as they are, not folded into the cell
};

PowderSnapshot powder_snapshot(const System<2>& system);

/// Group "snapshots" with a group 0, 1, ... for each, in the order of time: data sets positions (N x 2), radii (N) and
/// cell (2) [a], attribute time [T0].
void write_snapshots(const h5::Group& group, const std::vector<PowderSnapshot>& snapshots);

/// What write_snapshots wrote; empty without such a group. Throws FileTrouble when shapes do not fit.
std::vector<PowderSnapshot> read_snapshots(const h5::Group& group);

}  // namespace softgrain
