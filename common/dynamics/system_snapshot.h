// A mechanical system as a picture of its state.
#pragma once

#include "common/data/snapshot.h"
#include "common/system.h"

namespace softgrain {

/// Grains become particles in the order in which they were added, shells and planes walls, force-carrying contacts
/// those of contact_records(). Roles, bodies, names and what orders a series are for the caller to say: every grain
/// comes as a solid body of its own. Never changes the system. `contacts` false: without them.
template <int D>
Snapshot snapshot_of(const System<D>& system, bool contacts = true);

/// The contacts alone, sorted by (i, j), i and j counted as in snapshot_of.
template <int D>
std::vector<SnapshotContact> snapshot_contacts(const System<D>& system);

}  // namespace softgrain
