// One run of a scene from its beginning to its end.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/core/cost.h"
#include "common/io/hdf5_file.h"
#include "common/io/scene.h"
#include "pipelines/run/result_cache.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

/// Finished and half-finished tasks of a run, one small checkpoint each under DIR/work.
class TaskStore {
 public:
  /// Keeps what is there with --resume, starts empty otherwise. `beside` is what determines the run beside scene and
  /// seed: the text of a law file, say.
  TaskStore(const RunContext& context, const Scene& scene, std::uint64_t seed, const std::string& beside = "");

  void save(const std::string& task, const std::function<void(const h5::Group&)>& content) const;
  /// Which of the two copies that are kept may be read.
  enum class Copy {
    newest_valid,
    newest  ///< what other files go with: the copy before it is older than they are
  };
  /// Calls `read` with the saved content when there is one for this scene. One of which all copies that may be read are
  /// damaged, or those of another task, goes with a remark: its task starts afresh; returns false then.
  bool load(const std::string& task, const std::function<void(const h5::Group&)>& read,
            Copy copy = Copy::newest_valid) const;
  /// Whether anything is saved of a task.
  [[nodiscard]] bool has(const std::string& task) const;
  /// Removes what is saved of a task, with a remark that says why.
  void start_afresh(const std::string& task, const std::string& why) const;
  /// Wall time between two saves of a task that is under way [s].
  [[nodiscard]] double seconds() const { return context_.checkpoint_seconds(); }
  /// Removes what is saved of one task.
  void remove(const std::string& task) const;
  /// Removes everything: the run has ended well.
  void clear() const;

 private:
  /// Path of what is saved of a task, no longer than file systems take.
  [[nodiscard]] std::string file(const std::string& task) const;

  const RunContext& context_;
  std::string directory_;
  std::string fingerprint_;  ///< scene with overrides, seed, and what stands beside
};

/// What determines a run besides the text of its scene.
struct RunInputs {
  std::uint64_t seed = 0;            ///< seed of the scene; --seed goes before it
  std::vector<std::string> files{};  ///< files that it reads
  std::string text{};                ///< content that determines it: the text of a law file, say
};

/// A run: its directory, kept tasks, seed and provenance, and the clock; every part of the run is handed this.
class Run {
 public:
  const RunContext context;
  const std::uint64_t seed;
  const Provenance provenance;
  const TaskStore store;

  /// Begins the run, or goes on with it (--resume). Throws IoError, InputError as RunContext and TaskStore do.
  Run(const Scene& scene, const CommonOptions& options, const std::string& command, const RunInputs& inputs);

  /// Begins a part of another run, in a directory that is held already.
  Run(RunContext held, const Scene& scene, std::uint64_t scene_seed, const std::string& text = "");

  [[nodiscard]] std::string path(const std::string& file) const { return context.path(file); }
  /// Wall time since the beginning [s].
  [[nodiscard]] double seconds() const { return watch_.seconds(); }

  /// A result as an earlier part of this run kept it under `task`, else the one of `key` among those that runs share
  /// (`directory`: --law-cache and the like), else `make()`, which is kept in both. Without a task, or a directory, it
  /// is neither looked for nor kept there.
  template <class T, class Make>
  T get_or_make(const KeptForm<T>& form, const std::string& task, const std::string& directory, const std::string& key,
                Make&& make) const {
    std::optional<T> known;
    if (!task.empty()) store.load(task, [&](const h5::Group& g) { known = form.read(g); });
    const SharedResults shared(directory, [this](const std::string& remark) { context.say(remark); });
    if (!known) known = shared.find(form, key);
    if (known) return std::move(*known);
    T made = make();
    if (!task.empty()) store.save(task, [&](const h5::Group& g) { form.write(g, made); });
    shared.keep(form, key, made);
    return made;
  }

  /// RunContext::guard with the provenance of this run.
  void guard(const std::function<void()>& work) const { context.guard(provenance, work); }

  /// Ends the run: writes the summary ("provenance" added, and "seconds" unless it says itself what took how long) and
  /// the report, says `people`, how long it took and where the report is, and removes the kept tasks. Status not_usable
  /// unless the summary's "status" is "good".
  ExitStatus finish(nlohmann::json summary, const std::string& console) const;

 private:
  Stopwatch watch_;
};

/// What finish() does after the summary is written, for a run that was killed in between: writes the report if there is
/// none, removes the kept tasks.
void complete_ended_run(const std::string& directory);

}  // namespace softgrain
