// A sample under way, to files and back: everything a run needs to go on with the same bits.
#pragma once

#include "common/io/hdf5_file.h"
#include "microsim/powder/powder_assembly.h"

namespace softgrain {

/// Into `group`: data set "course" (columns named in its attribute), groups "progress" (attributes), "snapshots" and
/// "system".
void write_powder_state(const h5::Group& group, const PowderState& state);

/// Into a state whose system has been made from the same PowderSpec. Throws FileTrouble when something is missing.
void read_powder_state(const h5::Group& group, PowderState& state);

/// The system of a stored sample (a group with what write_powder_state wrote) with the law of its specification, to be
/// measured again. Throws FileTrouble.
System<2> read_powder_system(const h5::Group& group, const PowderSpec& spec);

}  // namespace softgrain
