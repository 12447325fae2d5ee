#include "pipelines/run/task_store.h"

#include <filesystem>

#include "common/state/checkpoint.h"

namespace softgrain {

TaskStore::TaskStore(const RunContext& context, const Scene& scene, std::uint64_t seed, const std::string& beside)
    : context_(context),
      directory_(context.path("work")),
      fingerprint_(scene.text() + "\n# seed " + std::to_string(seed) + "\n" + beside) {
  context.begin(scene, seed, beside);
  std::error_code error;
  if (!context.resume()) std::filesystem::remove_all(directory_, error);
}

void TaskStore::save(const std::string& task, const std::function<void(const h5::Group&)>& content) const {
  const std::lock_guard lock(h5::library_mutex());
  std::error_code error;
  std::filesystem::create_directories(directory_, error);
  if (error) throw IoError(directory_ + ": cannot be created: " + error.message());
  write_checkpoint(file(task), fingerprint_, content);
}

bool TaskStore::load(const std::string& task, const std::function<void(const h5::Group&)>& read) const {
  const std::lock_guard lock(h5::library_mutex());
  std::string note;
  std::optional<h5::Group> group;
  try {
    group = open_checkpoint(file(task), fingerprint_, note);
  } catch (const DamagedCheckpoint& e) {
    context_.say(std::string(e.what()) + ": " + task + " starts afresh");
    remove(task);
    return false;
  }
  if (!note.empty()) context_.say(note);
  if (group) read(*group);
  return true;
}

void TaskStore::remove(const std::string& task) const { remove_checkpoint(file(task)); }

void TaskStore::clear() const {
  std::error_code error;
  std::filesystem::remove_all(directory_, error);
}

}  // namespace softgrain
