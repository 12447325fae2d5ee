// Checkpoints: one file, written atomically with the previous one kept, tied to the scene it belongs to.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "common/core/error.h"
#include "common/io/hdf5_file.h"

namespace softgrain {

/// The disk gives every byte of a checkpoint, but not those that were written.
class DamagedCheckpoint : public IoError {
 public:
  using IoError::IoError;
};

/// Writes `path` (temporary file, flush, rename; the old one stays as path.previous), with schema and a fingerprint of
/// the scene.
void write_checkpoint(const std::string& path, const std::string& scene_text,
                      const std::function<void(const h5::Group&)>& content);

/// Opens the newest sound checkpoint for this scene: `path`, else path.previous (then `note` says so). Nothing when
/// neither exists. Throws InputError when it belongs to another scene or schema, DamagedCheckpoint when all
/// copies are damaged, IoError when one cannot be read.
std::optional<h5::Group> open_checkpoint(const std::string& path, const std::string& scene_text, std::string& note);

/// Removes the checkpoint and its previous copy after a run has ended well.
void remove_checkpoint(const std::string& path);

/// Wall time between two checkpoints of what lies between recorded points, unless told otherwise [s].
inline constexpr double kCheckpointSeconds = 5.0;

/// Says when the next checkpoint is due: after a wall time.
class CheckpointClock {
 public:
  explicit CheckpointClock(double seconds) : interval_(seconds), last_(std::chrono::steady_clock::now()) {}
  [[nodiscard]] bool due() {
    const auto now = std::chrono::steady_clock::now();
    if (std::chrono::duration<double>(now - last_).count() < interval_) return false;
    last_ = now;
    return true;
  }

 private:
  double interval_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace softgrain
