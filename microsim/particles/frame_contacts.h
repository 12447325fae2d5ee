// The contacts of some recorded frames of a run, for pictures: what touched whom, and with what force.
#pragma once

#include <cstdint>
#include <vector>

#include "common/data/snapshot.h"
#include "common/io/hdf5_file.h"
#include "common/system.h"

namespace softgrain {

/// Contacts of frame frame[k] are the next count[k] of `contacts`.
struct FrameContacts {
  std::vector<std::int64_t> frame;  ///< number of the frame in the trajectory, ascending
  std::vector<std::int64_t> count;
  std::vector<SnapshotContact> contacts;
};

/// Appends those of the system as it is. Never changes it.
template <int D>
void record_contacts(FrameContacts& to, std::int64_t frame, const System<D>& system);

/// Data sets frame, count and those of write_snapshot_contacts (snapshot_io.h); a segment list for the largest count.
void write_frame_contacts(const h5::Group& group, const FrameContacts& contacts);

/// `particles` and `bodies` (with walls) bound what contacts may name. Throws FileTrouble.
FrameContacts read_frame_contacts(const h5::Group& group, std::size_t particles, std::size_t bodies);

/// How many frames keep their contacts unless the scene says: fewer of large systems, so that they take about as much
/// room as 200,000 grains do.
std::int64_t default_snapshots(std::int64_t grains);

}  // namespace softgrain
