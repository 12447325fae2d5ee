// Any text as a scene of every kind: it is read, or refused with an Error; nothing else may happen.
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/core/error.h"
#include "common/io/scene.h"
#include "microsim/particles/particles_scene.h"
#include "pipelines/grain_box_setup.h"
#include "pipelines/hierarchy_setup.h"
#include "pipelines/law_table_setup.h"
#include "pipelines/macro_comparison.h"
#include "pipelines/measure_setup.h"
#include "pipelines/pipeline_setup.h"
#include "pipelines/powder_variants.h"

namespace {

using namespace softgrain;

void read_macro(const Scene& scene) {
  const SceneTable root = scene.root();
  LawSources choices;
  read_law_choices(root, choices);
  (void)read_macro_setup(root.table("macro"), SoftParticleSpec{});
}

/// The reader of the kind that the text names, as `softgrain check` chooses it.
void read(const Scene& scene) {
  const SceneTable root = scene.root();
  const std::string kind = root.choice("kind", {"pipeline", "soft-particle", "macro", "macro-comparison", "particles",
                                                "grain-box", "law-table", "cohesive-powder", "hierarchy"});
  if (kind == "pipeline") (void)read_pipeline_setup(root);
  if (kind == "soft-particle") (void)read_measure_setup(root);
  if (kind == "macro") read_macro(scene);
  if (kind == "macro-comparison") (void)read_macro_comparison(scene);
  if (kind == "particles" && particles_dimension(scene) == 2) (void)read_particles_scene<2>(scene);
  if (kind == "particles" && particles_dimension(scene) == 3) (void)read_particles_scene<3>(scene);
  if (kind == "grain-box") (void)read_grain_box(scene);
  if (kind == "law-table") (void)read_law_table(scene);
  if (kind == "hierarchy") (void)read_hierarchy_setup(root);
  if (kind != "cohesive-powder") return;
  if (has_powder_variants(scene))
    (void)read_powder_variants(scene);
  else
    (void)read_powder(scene);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    read(Scene::parse(text, "scene.toml"));
  } catch (const Error&) {  // the message that a user sees
  }
  return 0;
}
