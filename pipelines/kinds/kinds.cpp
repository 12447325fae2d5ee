#include "pipelines/kinds/kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "common/core/error.h"
#include "common/core/text.h"
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
#include "pipelines/results/summary.h"

namespace softgrain {

namespace {

/// Null when there is none.
const SceneKind* find(const std::string& name) {
  const auto kinds = scene_kinds();
  const auto at = std::find_if(kinds.begin(), kinds.end(), [&](const SceneKind& k) { return name == k.name; });
  return at == kinds.end() ? nullptr : &*at;
}

constexpr const char* kAnyKind = "run";  ///< the command that runs all of them

bool runs(const std::string& command, const SceneKind& kind) { return command == kAnyKind || command == kind.command; }

/// Names of the kinds that `command` runs.
std::vector<const char*> names_of(const std::string& command) {
  std::vector<const char*> names;
  for (const SceneKind& k : scene_kinds())
    if (runs(command, k)) names.push_back(k.name);
  return names;
}

/// "--engine, --ranks" of options and whether they are given.
std::string given_of(std::initializer_list<std::pair<const char*, bool>> options) {
  std::string text;
  for (const auto& [name, given] : options)
    if (given) append_part(text, name, ", ");
  return text;
}

/// Throws InputError for options that are given (`options` names them) where `takes` does not hold for the kind.
template <class Takes>
void refuse_options(const SceneKind& kind, const std::string& options, const Takes& takes) {
  if (options.empty() || takes(kind)) return;
  std::string kinds;
  for (const SceneKind& one : scene_kinds())
    if (takes(one)) append_part(kinds, fmt::format("\"{}\"", one.name), ", ");
  throw InputError(fmt::format("{}: not for scenes of kind \"{}\"; goes with {}", options, kind.name, kinds));
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

std::vector<RecordMember> summary_members(const SceneKind& kind) {
  if (kind.summary == nullptr) return {};
  std::vector<RecordMember> all = members_of<AnySummary>();
  for (RecordMember& own : kind.summary())
    if (std::ranges::find(all, own.path, &RecordMember::path) == all.end()) all.push_back(std::move(own));
  return all;
}

const SceneKind& kind_of(const Scene& scene) { return *find(scene.root().choice("kind", names_of(kAnyKind))); }

const SceneKind& kind_of(const Scene& scene, const std::string& command) {
  const SceneTable root = scene.root();
  const SceneKind* named = root.is_text("kind") ? find(root.text("kind")) : nullptr;
  if (named != nullptr && !runs(command, *named))
    root.throw_error("kind",
                     "scenes of this kind run with softgrain " + commands_of(*named, " or ") + ", not with " + command);
  return *find(root.choice("kind", names_of(command)));
}

std::string commands_of(const SceneKind& kind, const char* separator) {
  std::string text = kAnyKind;
  if (text != kind.command) append_part(text, kind.command, separator);
  return text;
}

void refuse_idle_options(const SceneKind& kind, const CommonOptions& o) {
  refuse_options(kind, given_of({{"--law-cache", !o.law_cache.empty()}}),
                 [](const SceneKind& k) { return k.keeps.measurements; });
  refuse_options(kind, given_of({{"--packing-cache", !o.packing_cache.empty()}}),
                 [](const SceneKind& k) { return k.keeps.packings; });
  refuse_options(kind, given_of({{"--twin-cache", !o.twin_cache.empty()}}),
                 [](const SceneKind& k) { return k.keeps.twins; });
  refuse_options(kind, given_of({{"--law", !o.law.empty()}, {"--bands", o.bands > 0}}),
                 [](const SceneKind& k) { return k.takes_law; });
  refuse_options(kind,
                 given_of({{"--engine", !o.engine.empty()}, {"--ranks", o.ranks > 0}, {"--write-only", o.write_only}}),
                 [](const SceneKind& k) { return k.takes_engine; });
}

}  // namespace softgrain
