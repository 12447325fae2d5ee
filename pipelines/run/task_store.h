// Finished and half-finished tasks of a run, one small checkpoint each under DIR/work.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "common/io/hdf5_file.h"
#include "common/io/scene.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

class TaskStore {
 public:
  /// Keeps what is there with --resume, starts empty otherwise. `beside` is what determines the run beside scene and
  /// seed: the text of a law file, say.
  TaskStore(const RunContext& context, const Scene& scene, std::uint64_t seed, const std::string& beside = "");

  void save(const std::string& task, const std::function<void(const h5::Group&)>& content) const;
  /// Calls `read` with the saved content when there is one for this scene. One of which all copies are damaged goes,
  /// with a remark: its task starts afresh; returns false then.
  bool load(const std::string& task, const std::function<void(const h5::Group&)>& read) const;
  /// Wall time between two saves of a task that is under way [s].
  [[nodiscard]] double seconds() const { return context_.checkpoint_seconds(); }
  /// Removes what is saved of one task.
  void remove(const std::string& task) const;
  /// Removes everything: the run has ended well.
  void clear() const;

 private:
  [[nodiscard]] std::string file(const std::string& task) const { return directory_ + "/" + task + ".h5"; }

  const RunContext& context_;
  std::string directory_;
  std::string fingerprint_;  ///< scene with overrides, seed, and what stands beside
};

}  // namespace softgrain
