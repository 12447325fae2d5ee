// What a kind of scene is to the commands: the table in kinds/kinds.h lists them all.
#pragma once

#include <string>

#include "common/io/scene.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/run/findings.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

struct SceneKind {
  const char* name = "";     ///< value of the key `kind`
  const char* command = "";  ///< command that runs it: "run", "microsim" or "macrosim"
  /// Reads the scene, runs it, writes what came out and the report; see the folder of the kind. Throws Error.
  ExitStatus (*run)(const Scene& scene, const CommonOptions& options) = nullptr;
  /// What follows from the scene without running it; `law` as in CommonOptions. Throws InputError, IoError.
  void (*check)(const Scene& scene, const std::string& law, Findings& out) = nullptr;
  /// Reads the scene to its last key, but no file that it names (a law, states): what a reader makes of any text.
  /// Throws InputError.
  void (*read)(const Scene& scene) = nullptr;
  /// Throws all that run() refuses before it begins, files that the scene names included; null: as `read`.
  void (*refuse)(const Scene& scene, const CommonOptions& options) = nullptr;
  KindResults results{};
  bool takes_law = false;     ///< whether --law goes with it
  bool takes_engine = false;  ///< whether --engine and what belongs to it do
};

}  // namespace softgrain
