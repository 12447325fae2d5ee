// One run of a scene from its beginning to its end.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/core/cost.h"
#include "pipelines/run/run_context.h"
#include "pipelines/run/task_store.h"

namespace softgrain {

/// What a run needs beside its scene.
struct RunInputs {
  std::vector<std::string> files{};  ///< files that it reads, besides the scene
  std::string text{};                ///< text that determines it, besides scene and seed: that of a law file, say
};

/// A run: its directory, kept tasks, seed and provenance, and the clock; every part of the run is handed this.
class Run {
 public:
  const RunContext context;
  const std::uint64_t seed;
  const Provenance provenance;
  const TaskStore store;

  /// Begins the run, or goes on with it (--resume). Throws IoError, InputError as RunContext and TaskStore do.
  Run(const Scene& scene, const CommonOptions& options, const std::string& command, std::uint64_t scene_seed,
      const RunInputs& inputs = {});

  /// Begins a part of another run, in a directory that is held already.
  Run(RunContext held, const Scene& scene, std::uint64_t scene_seed, const std::string& text = "");

  [[nodiscard]] std::string path(const std::string& file) const { return context.path(file); }
  /// Wall time since the beginning [s].
  [[nodiscard]] double seconds() const { return watch_.seconds(); }

  /// Ends the run: writes the summary ("provenance" added, and "seconds" unless it says itself what took how long) and
  /// the report, says `people`, how long it took and where the report is, and removes the kept tasks. Status not_usable
  /// unless the summary's "status" is "good".
  ExitStatus finish(nlohmann::json summary, const std::string& console) const;

 private:
  Stopwatch watch_;
};

}  // namespace softgrain
