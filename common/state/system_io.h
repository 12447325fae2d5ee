// The state of a system. The one that can be saved: everything a run needs to go on, bit for bit, to and from an HDF5
// group. Materials and laws are not in it: they come from the scene, whose text is compared on resume. And a picture
// of it.
#pragma once

#include "common/data/snapshot.h"
#include "common/io/hdf5_file.h"
#include "common/system.h"

namespace softgrain {

/// Writes bodies, velocities, forces of the last pass, cell, contact histories, neighbour references, clock and
/// counters.
template <int D>
void write_system(const h5::Group& group, const System<D>& system);

/// Restores what write_system wrote into a system that already has its materials and laws. The neighbour list is taken
/// over as it was, so that later rebuilds fall on the same steps; constants of the pairs come from the laws. Needs no
/// force pass before the next step. Throws IoError.
template <int D>
void read_system(const h5::Group& group, System<D>& system);

// A mechanical system as a picture of its state.

/// Grains become particles in the order in which they were added, shells and planes walls, force-carrying contacts
/// those of contact_records(). Roles, bodies, names and what orders a series are for the caller to say: every grain
/// comes as a solid body of its own. Never changes the system. `contacts` false: without them.
template <int D>
Snapshot snapshot_of(const System<D>& system, bool contacts = true);

/// The contacts alone, sorted by (i, j), i and j counted as in snapshot_of.
template <int D>
std::vector<SnapshotContact> snapshot_contacts(const System<D>& system);

}  // namespace softgrain
