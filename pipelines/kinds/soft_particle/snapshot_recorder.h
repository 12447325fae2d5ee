// States of a run that are kept for pictures, task by task, until they go to a file of their own.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/data/snapshot.h"
#include "common/io/provenance.h"
#include "common/io/scene.h"
#include "pipelines/run/run.h"

namespace softgrain {

inline constexpr std::int64_t kKeptStates = 4;

/// What [output] says: how many recorded states of a series are kept, evenly spread; 0: none. Throws InputError.
std::int64_t read_kept_states(const SceneTable& root, std::int64_t fallback = kKeptStates);

/// The states of one series under way. Each is in the store before the point it belongs to: a run that is resumed has
/// those it needs, and makes later ones again.
class SnapshotRecorder {
 public:
  /// Nothing is kept when `wanted` is 0. `points`: recorded points of the series. Made before the task itself is
  /// loaded: where the states are damaged, the task starts afresh, for it makes each of them once.
  SnapshotRecorder(const TaskStore& store, const std::string& task, std::int64_t points, std::int64_t wanted);

  [[nodiscard]] bool wants(std::int64_t point) const { return is_snapshot(point, points_, wanted_); }
  /// Replaces one of the same point.
  void add(Snapshot snapshot, std::int64_t point);
  [[nodiscard]] bool has(std::int64_t point) const;
  /// Takes all states, in the order of points.
  [[nodiscard]] std::vector<Snapshot> take() { return std::move(states_); }

 private:
  const TaskStore& store_;
  std::string task_;
  std::int64_t points_;
  std::int64_t wanted_;
  std::vector<Snapshot> states_;
};

/// Writes them to a file, and XDMF files beside it; without any, a file that an earlier run left there goes. Throws
/// IoError.
void save_kept_states(const std::vector<Snapshot>& states, const std::string& path, const Provenance& provenance);

}  // namespace softgrain
