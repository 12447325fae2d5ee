// Powders in files: what one is made of, and a sample under way with everything that a run needs to go on with the same
// bits; where its disks were at moments of its assembly.
#pragma once

#include <vector>

#include "common/io/hdf5_file.h"
#include "common/system.h"
#include "microsim/powder/powder_start.h"

namespace softgrain {

struct PowderState;
struct PowderStage;

struct PowderSnapshot {
  double time = 0.0;             ///< [T0]
  Vec<2> lengths{};              ///< lengths of the periodic cell [a]
  std::vector<Sphere<2>> disks;  ///< centres as they are, not folded into the cell
};

PowderSnapshot powder_snapshot(const System<2>& system);

/// Group "snapshots" with a group 0, 1, ... for each, in the order of time: data sets positions (N x 2), radii (N) and
/// cell (2) [a], attribute time [T0].
void write_snapshots(const h5::Group& group, const std::vector<PowderSnapshot>& snapshots);

/// What write_snapshots wrote; empty without such a group. Throws IoError when shapes do not fit.
std::vector<PowderSnapshot> read_snapshots(const h5::Group& group);

/// Every member of the specification as an attribute of `group`, by its name.
void write_powder_spec(const h5::Group& group, const PowderSpec& spec);

/// Throws IoError when an attribute is missing.
PowderSpec read_powder_spec(const h5::Group& group);

/// Writes into `group`: data set "course" (columns named in its attribute), groups "progress" (attributes), "snapshots"
/// and "system".
void write_powder_state(const h5::Group& group, const PowderState& state);

/// Reads into a state whose system has been made from the same PowderSpec. Throws IoError when something is missing.
void read_powder_state(const h5::Group& group, PowderState& state);

/// Reads the stages of a written state; empty where an earlier program left none.
std::vector<PowderStage> read_stages(const h5::Group& group);

/// The system of a stored sample (a group with what write_powder_state wrote) with the law of its specification, to be
/// measured again. Throws IoError.
System<2> read_powder_system(const h5::Group& group, const PowderSpec& spec);

}  // namespace softgrain
