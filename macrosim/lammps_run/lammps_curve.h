// What LAMMPS recorded, as the curve and the states that our own engine would have.
#pragma once

#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "common/data/snapshot.h"
#include "macrosim/lammps_run/dump_files.h"
#include "macrosim/lammps_run/points_file.h"
#include "macrosim/macro_system.h"

namespace softgrain::lammps {

/// Appends the rows to a curve that begin_curve() made; notes that a law was refused or a relaxation did not converge
/// are those of our own engine. Throws IoError when strains are not those of the test.
void add_points(const std::vector<PointRow>& rows, const MacroSpec& spec, MacroCurve& curve);

/// Whether the test ended before its last recorded point, and there is nothing to go on with.
bool ended_early(const PointRow& row);

/// The normal forces of a state, as in MacroCurve::body_forces.
std::vector<double> normal_forces(const std::vector<DumpedContact>& contacts);

/// Moves bodies and walls of a system to where they were dumped.
void move_to(const DumpedBodies& bodies, MacroSystem& macro);

/// Contacts of a snapshot of that system.
std::vector<SnapshotContact> snapshot_contacts_of(const std::vector<DumpedContact>& contacts, const MacroSystem& macro);

}  // namespace softgrain::lammps
