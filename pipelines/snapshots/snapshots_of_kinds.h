// States out of the files of kinds of runs that keep them in a form of their own.
#pragma once

#include <functional>
#include <string>

#include "pipelines/snapshots/snapshots.h"

namespace softgrain {

/// run.h5 of kind "particles": every recorded frame, with the contacts of those that kept them; frames whose numbers
/// were lost are left out. Throws FileTrouble.
void visit_particles(const std::string& path, SnapshotChoice choice, const std::function<void(const Snapshot&)>& visit);

/// powder.h5: pictures of the assembly without contacts, then the state that it ended in, with them. Throws
/// FileTrouble.
void visit_powder(const std::string& path, SnapshotChoice choice, const std::function<void(const Snapshot&)>& visit);

/// grain_box.h5: the last state of every pack, one series each, whatever the choice. Throws FileTrouble.
void visit_grain_boxes(const std::string& path, SnapshotChoice choice,
                       const std::function<void(const Snapshot&)>& visit);

}  // namespace softgrain
