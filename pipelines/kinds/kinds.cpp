#include "pipelines/kinds/kinds.h"

#include <algorithm>
#include <array>
#include <vector>

#include "pipelines/kinds/cohesive_powder/run.h"
#include "pipelines/kinds/grain_box/run.h"
#include "pipelines/kinds/hierarchy/run.h"
#include "pipelines/kinds/inverse/run.h"
#include "pipelines/kinds/law_table/run.h"
#include "pipelines/kinds/macro/run.h"
#include "pipelines/kinds/macro_comparison/run.h"
#include "pipelines/kinds/particles/run.h"
#include "pipelines/kinds/pipeline/run.h"
#include "pipelines/kinds/soft_particle/run.h"

namespace softgrain {

std::span<const SceneKind> scene_kinds() {
  static const std::array kinds{pipeline_kind(), macro_comparison_kind(), law_table_kind(), hierarchy_kind(), inverse_kind(), soft_particle_kind(), particles_kind(), grain_box_kind(), cohesive_powder_kind(), macro_kind()};
  return kinds;
}

const SceneKind& kind_of(const Scene& scene) {
  std::vector<const char*> names;
  for (const SceneKind& k : scene_kinds()) names.push_back(k.name);
  const std::string kind = scene.root().choice("kind", names);
  return *std::find_if(scene_kinds().begin(), scene_kinds().end(), [&](const SceneKind& k) { return kind == k.name; });
}

const SceneKind& kind_of(const Scene& scene, const std::string& command) {
  const SceneTable root = scene.root();
  std::vector<const char*> names;
  for (const SceneKind& k : scene_kinds())
    if (command == k.command) names.push_back(k.name);
  if (root.is_text("kind")) {
    const std::string kind = root.text("kind");
    for (const SceneKind& k : scene_kinds())
      if (kind == k.name && command != k.command)
        root.reject("kind",
                    "scenes of this kind run with softgrain " + std::string(k.command) + ", not with " + command);
  }
  const std::string kind = root.choice("kind", names);
  return *std::find_if(scene_kinds().begin(), scene_kinds().end(), [&](const SceneKind& k) { return kind == k.name; });
}

}  // namespace softgrain
