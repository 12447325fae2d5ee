#include "pipelines/kinds/kinds.h"

#include <algorithm>
#include <array>
#include <vector>

#include "pipelines/kinds/cohesive_powder/scene.h"
#include "pipelines/kinds/grain_box/scene.h"
#include "pipelines/kinds/hierarchy/scene.h"
#include "pipelines/kinds/inverse/scene.h"
#include "pipelines/kinds/law_table/scene.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/macro_comparison/scene.h"
#include "pipelines/kinds/material/scene.h"
#include "pipelines/kinds/material_law/scene.h"
#include "pipelines/kinds/material_models/scene.h"
#include "pipelines/kinds/particles/scene.h"
#include "pipelines/kinds/pipeline/scene.h"
#include "pipelines/kinds/recipe/scene.h"
#include "pipelines/kinds/soft_particle/scene.h"

namespace softgrain {

namespace {

/// Null when there is none.
const SceneKind* find(const std::string& name) {
  const auto kinds = scene_kinds();
  const auto at = std::find_if(kinds.begin(), kinds.end(), [&](const SceneKind& k) { return name == k.name; });
  return at == kinds.end() ? nullptr : &*at;
}

/// Names of the kinds that `command` runs; names of all kinds when it is empty.
std::vector<const char*> names_of(const std::string& command) {
  std::vector<const char*> names;
  for (const SceneKind& k : scene_kinds())
    if (command.empty() || command == k.command) names.push_back(k.name);
  return names;
}

}  // namespace

std::span<const SceneKind> scene_kinds() {
  static const std::array kinds{
      pipeline_kind(),      macro_comparison_kind(), law_table_kind(),       hierarchy_kind(),       inverse_kind(),
      soft_particle_kind(), particles_kind(),        grain_box_kind(),       cohesive_powder_kind(), macro_kind(),
      material_kind(),      material_law_kind(),     material_models_kind(), recipe_kind()};
  return kinds;
}

const std::vector<KindResults>& results_of_kinds() {
  static const std::vector<KindResults> results = [] {
    std::vector<KindResults> all;
    for (const SceneKind& kind : scene_kinds()) {
      all.push_back(kind.results);
      all.back().kind = kind.name;
    }
    return all;
  }();
  return results;
}

const SceneKind& kind_of(const Scene& scene) { return *find(scene.root().choice("kind", names_of(""))); }

const SceneKind& kind_of(const Scene& scene, const std::string& command) {
  const SceneTable root = scene.root();
  const SceneKind* named = root.is_text("kind") ? find(root.text("kind")) : nullptr;
  if (named != nullptr && command != named->command)
    root.throw_error("kind",
                     "scenes of this kind run with softgrain " + std::string(named->command) + ", not with " + command);
  return *find(root.choice("kind", names_of(command)));
}

}  // namespace softgrain
