// What LAMMPS recorded, as the curve and the states that our own engine would have; where a test goes on.
#pragma once

#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "common/data/snapshot.h"
#include "macrosim/lammps_run/dump_files.h"
#include "macrosim/lammps_run/points_file.h"
#include "macrosim/macro_spec.h"
#include "macrosim/macro_system.h"

namespace softgrain::lammps {

/// Appends the rows to a curve that begin_curve() made; notes that a law was refused or a relaxation did not converge
/// are those of our own engine. Throws IoError when strains, or the stresses asked for, are not those of the
/// test.
void add_points(const std::vector<PointRow>& rows, const MacroSpec& spec, MacroCurve& curve);

/// Whether the test ended before its last recorded point, and there is nothing to go on with.
bool ended_early(const PointRow& row);

/// The normal forces of a state, as in MacroCurve::body_forces.
std::vector<double> normal_forces(const std::vector<DumpedContact>& contacts);

/// Moves bodies and walls of a system to where they were dumped.
void move_to(const DumpedBodies& bodies, MacroSystem& macro);

/// Contacts of a snapshot of that system.
std::vector<SnapshotContact> snapshot_contacts_of(const std::vector<DumpedContact>& contacts, const MacroSystem& macro);

// Where a test in LAMMPS goes on.

struct ResumePoint {
  bool done = false;                  ///< everything is recorded and the last state is there
  std::vector<std::string> settings;  ///< "-var", NAME, VALUE...
};

/// Finds where a test goes on, from the tables and restart files in the directory of a sample. Brings points.txt to the
/// point that the run goes on after. `stages`: for a test in stages, so that the script is told at which stresses they
/// began. `more`: as for read_points(). Throws what read_points() throws.
ResumePoint find_resume_point(const std::string& directory, const std::string& key, std::int64_t points,
                              const std::vector<MacroStage>& stages = {}, const std::vector<std::string>& more = {});

/// How far a compaction in LAMMPS is, 0 to 1, from its table; it moves with every pressure.
double compaction_share(const std::string& directory);

}  // namespace softgrain::lammps
