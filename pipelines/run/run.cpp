#include "pipelines/run/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/dynamics/thread_choice.h"
#include "common/io/text_file.h"
#include "common/state/checkpoint.h"
#include "pipelines/report/report.h"
#include "pipelines/results/summary.h"

namespace softgrain {

namespace {

/// Folder of a run directory for results of tasks until the run ends.
constexpr const char* kTaskFolder = "work";

/// Attribute of the file of a task: its name. All tasks of a run share the fingerprint of the scene.
constexpr const char* kTaskName = "task";

}  // namespace

TaskStore::TaskStore(const RunContext& context, const Scene& scene, std::uint64_t seed, const std::string& beside)
    : context_(context),
      directory_(context.path(kTaskFolder)),
      fingerprint_(scene.text() + "\n# seed " + std::to_string(seed) + "\n" + beside) {
  context.begin(scene, seed, beside);
  std::error_code error;
  if (!context.resume()) std::filesystem::remove_all(directory_, error);
}

/// Tasks carry several names of a scene: of a model, a variant and a loading. File systems take 255 characters, the
/// endings ".h5.previous" and ".h5.tmp" among them.
std::string TaskStore::file(const std::string& task) const {
  constexpr std::size_t kLongest = 220;
  if (task.size() <= kLongest) return directory_ + "/" + task + ".h5";
  const std::string hash = "-" + short_hash(task);
  return directory_ + "/" + task.substr(0, kLongest - hash.size()) + hash + ".h5";
}

void TaskStore::save(const std::string& task, const std::function<void(const h5::Group&)>& content) const {
  const std::lock_guard lock(h5::library_mutex());
  std::error_code error;
  std::filesystem::create_directories(directory_, error);
  if (error) throw IoError(directory_ + ": cannot be created: " + error.message());
  write_checkpoint(file(task), fingerprint_, [&](const h5::Group& root) {
    root.attribute(kTaskName, task);
    content(root);
  });
}

bool TaskStore::load(const std::string& task, const std::function<void(const h5::Group&)>& read, Copy copy) const {
  const std::lock_guard lock(h5::library_mutex());
  std::string note;
  std::optional<h5::Group> group;
  try {
    group = open_checkpoint(file(task), fingerprint_, note);
  } catch (const DamagedCheckpoint& e) {
    start_afresh(task, e.what());
    return false;
  }
  std::error_code ignored;
  const bool older = !note.empty() || !std::filesystem::exists(file(task), ignored);
  std::string why;
  if (group && older && copy == Copy::newest)
    why = "the newest copy is damaged or gone";
  else if (group && group->has_attribute(kTaskName) && group->text(kTaskName) != task)
    why = "holds the task " + group->text(kTaskName);
  if (!why.empty()) {
    start_afresh(task, file(task) + ": " + why);
    return false;
  }
  if (!note.empty()) context_.say(note);
  if (group) h5::naming_file(file(task), [&] { read(*group); });
  return true;
}

bool TaskStore::has(const std::string& task) const {
  std::error_code ignored;
  return std::filesystem::exists(file(task), ignored) || std::filesystem::exists(file(task) + ".previous", ignored);
}

void TaskStore::start_afresh(const std::string& task, const std::string& why) const {
  context_.say(why + ": " + task + " starts afresh");
  remove(task);
}

void TaskStore::remove(const std::string& task) const { remove_checkpoint(file(task)); }

void TaskStore::clear() const {
  std::error_code error;
  std::filesystem::remove_all(directory_, error);
}

Run::Run(const Scene& scene, const CommonOptions& options, const std::string& command, const RunInputs& inputs)
    : Run(RunContext(options, command, std::filesystem::path(scene.path()).stem().string(), inputs.files), scene,
          inputs.seed, inputs.text) {}

Run::Run(RunContext held, const Scene& scene, std::uint64_t scene_seed, const std::string& text)
    : context(std::move(held)),
      seed(context.seed(scene_seed)),
      provenance(context.provenance(scene, seed)),
      store(context, scene, seed, text) {}

namespace {

/// Where all threads did not pay; empty elsewhere. A matter of the machine, so on the terminal and in the log
/// alone.
std::string fewer_threads_text() {
  constexpr double kLong = 5.0;  // [s]
  constexpr double kMost = 0.5;
  const ThreadUse use = thread_use();
  if (use.fewer < std::max(kLong, kMost * use.seconds)) return "";
  return fmt::format(
      "{:.0f} % of the integration time used fewer threads: more were not faster (small scene or busy cores)\n",
      100.0 * use.fewer / use.seconds);
}

}  // namespace

ExitStatus Run::finish(nlohmann::json summary, const std::string& console) const {
  if (!summary.contains("seconds")) summary["seconds"] = seconds();
  const bool good = is_good(summary.value("status", ""));
  context.finish(std::move(summary), provenance,
                 console + fewer_threads_text() + fmt::format("{:.0f} s; report: {}", seconds(), path("report.html")));
  write_report(context.directory());
  store.clear();
  return good ? ExitStatus::good : ExitStatus::not_usable;
}

void complete_ended_run(const std::string& directory) {
  std::error_code ignored;
  if (!std::filesystem::exists(directory + "/report.html", ignored)) write_report(directory);
  std::filesystem::remove_all(directory + "/" + kTaskFolder, ignored);
}

}  // namespace softgrain
