#include "pipelines/kinds/soft_particle/snapshot_recorder.h"

#include <algorithm>
#include <filesystem>

#include "common/data/snapshot_io.h"
#include "pipelines/export/export.h"

namespace softgrain {

namespace {

constexpr std::int64_t kMostStates = 10'000;

}  // namespace

std::int64_t read_kept_states(const SceneTable& root, std::int64_t fallback) {
  return root.table_or_empty({"output", "states kept for pictures"})
      .count({"snapshots",
              "number of states that are kept for pictures, spread evenly over the recorded points, the last one among "
              "them; 0: none. Results do not depend on it"},
             0, kMostStates, fallback);
}

SnapshotRecorder::SnapshotRecorder(const TaskStore& store, const std::string& task, std::int64_t points,
                                   std::int64_t wanted)
    : store_(store), task_(task + "-states"), points_(points), wanted_(wanted) {
  if (wanted_ <= 0) return;
  const bool there = store_.has(task_);
  // The copy before the newest lacks states of points that the task has behind it.
  const bool whole = store_.load(
      task_, [&](const h5::Group& g) { states_ = read_snapshot_list(g); }, TaskStore::Copy::newest);
  if (!whole)
    store_.remove(task);
  else if (!there && store_.has(task))
    store_.start_afresh(task, "the states that it has kept are gone");
  // Even without states: whether they are missing can then be told.
  if (!store_.has(task_)) store_.save(task_, [&](const h5::Group& g) { write_snapshot_list(g, states_); });
}

bool SnapshotRecorder::has(std::int64_t point) const {
  return std::any_of(states_.begin(), states_.end(), [&](const Snapshot& s) { return s.frame == point; });
}

void SnapshotRecorder::add(Snapshot snapshot, std::int64_t point) {
  snapshot.frame = point;
  std::erase_if(states_, [&](const Snapshot& s) { return s.frame >= point; });
  states_.push_back(std::move(snapshot));
  store_.save(task_, [&](const h5::Group& g) { write_snapshot_list(g, states_); });
}

void save_kept_states(const std::vector<Snapshot>& states, const std::string& path, const Provenance& provenance) {
  if (!states.empty()) {
    const std::lock_guard lock(h5::library_mutex());
    save_snapshots(states, path, provenance);
    write_states_xdmf(path);
    return;
  }
  std::error_code nothing_there;
  std::filesystem::remove(path, nothing_there);
  for (const std::string& beside : states_xdmf_files(path)) std::filesystem::remove(beside, nothing_there);
}

}  // namespace softgrain
