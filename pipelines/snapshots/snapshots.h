// The states that a run directory holds, whatever kind of run it is, in one form.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/data/snapshot.h"
#include "pipelines/results/kind_results.h"

namespace softgrain {

/// What is where: states_*.h5 (soft particles, macro runs and their twins), and the files in which kinds keep states in
/// a form of their own (also one level below, of variants). A directory: all of them, a file: that one.
/// Empty for a directory without any. Throws IoError (missing, damaged), InputError for a file
/// of another kind.
std::vector<Snapshot> read_snapshots(const std::string& run, SnapshotChoice choice = SnapshotChoice::all);

/// One after another, series by series in their order, without holding all in memory.
void for_each_snapshot(const std::string& run, SnapshotChoice choice,
                       const std::function<void(const Snapshot&)>& visit);

/// Whether files of this name hold states.
bool holds_states(const std::string& file_name);

/// The files that for_each_snapshot reads of a run, in its order.
std::vector<std::string> snapshot_files(const std::string& run);

}  // namespace softgrain
