// Finished and half-finished tasks of a run, one small checkpoint each under DIR/work.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "common/io/hdf5_file.h"
#include "common/io/scene.h"
#include "pipelines/run_context.h"

namespace softgrain {

/// The HDF5 library is not thread-safe here: all access of a run goes through this one lock.
std::mutex& hdf5_mutex();

class TaskStore {
 public:
  /// Keeps what is there with --resume, starts empty otherwise.
  TaskStore(const RunContext& context, const Scene& scene, std::uint64_t seed);

  void save(const std::string& task, const std::function<void(const h5::Group&)>& content) const;
  /// Calls `read` with the saved content when there is one for this scene.
  void load(const std::string& task, const std::function<void(const h5::Group&)>& read) const;
  /// Removes everything: the run has ended well.
  void clear() const;

 private:
  [[nodiscard]] std::string file(const std::string& task) const { return directory_ + "/" + task + ".h5"; }

  const RunContext& context_;
  std::string directory_;
  std::string fingerprint_;  ///< scene with overrides and seed
};

}  // namespace softgrain
