// States of a run in HDF5, laid out so that ParaView reads them through a small XDMF file beside.
#pragma once

#include <string>
#include <vector>

#include "common/data/snapshot.h"
#include "common/io/hdf5_file.h"
#include "common/io/provenance.h"

namespace softgrain {

/// Data sets pair (C x 2), ends (2C x 3: from, to), point (C x 3), force (C x 3), normal_force (C), shift (C x 3, when
/// any is not zero) and segment (S x 2: rows of `ends` that one line joins, S = the largest of `segments`, or C).
void write_snapshot_contacts(const h5::Group& group, const std::vector<SnapshotContact>& contacts,
                             const Snapshot& units, std::size_t segments);
/// What a contact may name: i a particle, j any body, particles first.
struct SnapshotBodies {
  std::size_t particles = 0;
  std::size_t all = 0;
};
/// Throws IoError when shapes or units are others, a number is not finite, a contact names a body that is not
/// there, or a line joins other rows than those of its contact.
std::vector<SnapshotContact> read_snapshot_contacts(const h5::Group& group, const SnapshotBodies& bodies,
                                                    const Snapshot& units);

/// One state: attributes, particles (position, radius, id, role, body, material, index; velocity and spin where they
/// count, mass where all are known), walls, cell, and the group "contacts".
void write_snapshot(const h5::Group& group, const Snapshot& snapshot);
/// Throws IoError when arrays do not fit together or a number is not finite.
Snapshot read_snapshot(const h5::Group& group);

/// Group "states" with one child per state, in order.
void write_snapshot_list(const h5::Group& group, const std::vector<Snapshot>& snapshots);
std::vector<Snapshot> read_snapshot_list(const h5::Group& group);

/// A file of states. Atomic. Throws IoError.
void save_snapshots(const std::vector<Snapshot>& snapshots, const std::string& path, const Provenance& provenance);

/// Opens a file of states and checks its format. Throws IoError.
h5::Group open_snapshots(const std::string& path);

}  // namespace softgrain
