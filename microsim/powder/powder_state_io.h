// Powders in files: what one is made of, and a sample under way with everything that a run needs to go on with the same
// bits; where its disks were at moments of its assembly.
#pragma once

#include <vector>

#include "common/data/snapshot_frames.h"
#include "common/io/hdf5_file.h"
#include "common/system.h"
#include "microsim/powder/powder_start.h"

namespace softgrain {

struct PowderPoint;
struct PowderState;
struct PowderStage;

/// Appends positions and cell of the system as it is: centres as they are, not folded into the cell.
void record_snapshot(Trajectory& snapshots, const System<2>& system);

/// The snapshots of an assembly; empty where a sample has none, in the form of version 0.2 too. Throws IoError.
Trajectory read_snapshots(const h5::Group& group);

/// What all snapshots of powders say of themselves: units and dimension.
Snapshot powder_frames();

/// Every member of the specification as an attribute of `group`, by its name.
void write_powder_spec(const h5::Group& group, const PowderSpec& spec);

/// Throws IoError when an attribute is missing.
PowderSpec read_powder_spec(const h5::Group& group);

/// Writes into `group`: data set "course" (columns named in its attribute), groups "progress" (attributes),
/// "trajectory" (snapshots) and "system".
void write_powder_state(const h5::Group& group, const PowderState& state);

/// Reads into a state whose system has been made from the same PowderSpec. Throws IoError when something is missing.
void read_powder_state(const h5::Group& group, PowderState& state);

/// The recorded points of a written state.
std::vector<PowderPoint> read_course(const h5::Group& group);
/// The stages of a written state; empty where an earlier program left none.
std::vector<PowderStage> read_stages(const h5::Group& group);

/// The system of a stored sample (a group with what write_powder_state wrote) with the law of its specification, to be
/// measured again. Throws IoError.
System<2> read_powder_system(const h5::Group& group, const PowderSpec& spec);

}  // namespace softgrain
