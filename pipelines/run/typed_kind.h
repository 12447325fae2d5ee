// A kind of scene over its own `Setup`, all that a scene of it says: how most kinds stand in the table of kinds.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipelines/run/run.h"
#include "pipelines/run/scene_kind.h"

namespace softgrain {

/// What a run came to.
struct Outcome {
  nlohmann::json summary;  ///< for summary.json; its "status" decides the exit status
  std::string console;     ///< a few lines for people
};

template <class Setup>
struct TypedKind {
  const char* name = "";     ///< value of the key `kind`
  const char* command = "";  ///< as SceneKind::command
  /// All that the scene says. Throws InputError.
  Setup (*read)(const Scene& scene) = nullptr;
  /// Seed of the scene, and what determines a run besides it and the scene's text.
  RunInputs (*inputs)(const Setup& setup) = nullptr;
  /// Makes and writes all results but the summary and the report. Throws Error.
  Outcome (*run)(const Setup& setup, const Run& run) = nullptr;
  /// What follows from the scene without running it. Throws InputError, IoError.
  void (*check)(const Setup& setup, Findings& out) = nullptr;
  KindResults results{};
  std::vector<RecordMember> (*summary)() = nullptr;  ///< as SceneKind::summary
  KeptBetweenRuns keeps{};                           ///< as SceneKind::keeps
  std::vector<std::string> explored_from{""};        ///< as SceneKind::explored_from
  const char* starter = "";                          ///< as SceneKind::starter
};

/// The entry of such a kind in the table; each function of it reads the scene once.
template <class Setup>
SceneKind scene_kind(const TypedKind<Setup>& kind) {
  return {
      .name = kind.name,
      .command = kind.command,
      .run =
          [kind](const Scene& scene, const CommonOptions& options) {
            const Setup setup = kind.read(scene);
            const Run run(scene, options, kind.command, kind.inputs(setup));
            const Outcome outcome = kind.run(setup, run);
            return run.finish(outcome.summary, outcome.console);
          },
      .check = [kind](const Scene& scene, const CommonOptions&, Findings& out) { kind.check(kind.read(scene), out); },
      .read = [kind](const Scene& scene) { (void)kind.read(scene); },
      .results = kind.results,
      .summary = kind.summary,
      .keeps = kind.keeps,
      .explored_from = kind.explored_from,
      .starter = kind.starter};
}

}  // namespace softgrain
