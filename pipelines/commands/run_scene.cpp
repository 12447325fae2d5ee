// softgrain run, microsim, macrosim: one scene; its `kind` says which.
#include "common/core/error.h"
#include "pipelines/kinds/kinds.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

namespace {

ExitStatus run_scene(const CommonOptions& options, const std::string& command) {
  if (options.inputs.size() != 1)
    throw BadInput(command + ": one scene is needed (softgrain " + command + " SCENE.toml)");
  const Scene scene = Scene::load(options.inputs.front(), options.overrides);
  return kind_of(scene, command).run(scene, options);
}

}  // namespace

ExitStatus command_run(const CommonOptions& options) { return run_scene(options, "run"); }

ExitStatus command_microsim(const CommonOptions& options) { return run_scene(options, "microsim"); }

ExitStatus command_macrosim(const CommonOptions& options) { return run_scene(options, "macrosim"); }

}  // namespace softgrain
