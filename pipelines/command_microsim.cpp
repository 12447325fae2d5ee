// softgrain microsim SCENE.toml: one particle-scale scene; its `kind` says which.
#include "pipelines/grain_box_command.h"
#include "pipelines/particles_command.h"
#include "pipelines/powder_command.h"
#include "pipelines/run_context.h"
#include "pipelines/scene_kind.h"
#include "pipelines/soft_particle_command.h"

namespace softgrain {

ExitStatus command_microsim(const CommonOptions& options) {
  if (options.inputs.size() != 1) throw BadInput("microsim: one scene is needed (softgrain microsim SCENE.toml)");
  const Scene scene = Scene::load(options.inputs.front(), options.overrides);
  refuse_other_commands(scene.root(), "microsim");
  const std::string kind = scene.root().choice("kind", {"soft-particle", "particles", "grain-box", "cohesive-powder"});
  if (kind == "particles") return run_particles_scene(scene, options);
  if (kind == "cohesive-powder") return run_powder_scene(scene, options);
  if (kind == "grain-box") return run_grain_box_scene(scene, options);
  return run_soft_particle_scene(scene, options);
}

}  // namespace softgrain
