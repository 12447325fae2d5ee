// Reads scenes of kind "macro-comparison", and says what follows from them: softgrain check.
#include "pipelines/kinds/macro_comparison/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "common/core/text.h"
#include "pipelines/kinds/macro/check.h"
#include "pipelines/kinds/macro/room.h"
#include "pipelines/kinds/macro/stage.h"
#include "pipelines/kinds/macro/stages.h"
#include "pipelines/kinds/soft_particle/check.h"
#include "pipelines/kinds/soft_particle/scene.h"
#include "pipelines/kinds/soft_particle/snapshot_recorder.h"

namespace softgrain {

namespace {

std::string default_name(const MacroSpec& spec) {
  return fmt::format("{}-{:g}", to_string(spec.test), 100.0 * spec.soft_share);
}

bool valid_name(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-';
  });
}

ComparisonScene read_scene(const SceneTable& root, const SceneTable& t, const MacroSetup& base,
                           const SoftParticleSpec& content, const std::vector<ComparisonScene>& before,
                           std::uint64_t seed, bool valid, bool modulus_is_known) {
  ComparisonScene scene;
  scene.setup = read_macro_setup(t, base);
  read_part_stages(root, t, scene.setup.spec, modulus_is_known);
  refuse_idle_test_keys(t, t.has("stage") ? t : root, {&scene.setup.spec});
  refuse_idle_keys(t, !scene.setup.twins.empty(), scene.setup.bands > 0);
  refuse_idle_sizes(t, {&scene.setup});
  require_own_preparation(t, scene.setup);
  if (valid) require_macro_memory(t, scene.setup, content);
  if (valid && !t.has_errors()) require_room_for_images(t, "bodies", scene.setup, seed);
  std::string name = default_name(scene.setup.spec);
  std::replace(name.begin(), name.end(), '.', '-');
  scene.name = t.text({"name", "name of the scene in file names", "test and soft share"}, name);
  if (!valid_name(scene.name)) t.add_error("name", "letters, digits and '-' only: it becomes part of file names");
  require_short_name(t, scene.name);
  if (scene.name == "initial") t.add_error("name", "files of packings are called so: give another name");
  for (const ComparisonScene& s : before)
    if (s.name == scene.name)
      t.add_error("name", "another scene is called '" + s.name + "' already; give this one a name");
  return scene;
}

/// Refuses the choice of a tangential stiffness where no law has two of them.
void refuse_idle_slopes(const MacroComparisonSetup& setup, const SceneTable& macro,
                        const std::vector<SceneTable>& parts) {
  constexpr const char* kWhy = "goes with a law card; a law table has one tangential stiffness";
  bool any = setup.scenes.empty();
  for (std::size_t k = 0; k < setup.scenes.size(); ++k) {
    const LawSources& laws = setup.laws_of(setup.scenes[k]);
    const bool chooses = laws.laws.empty() || laws.card() != nullptr;  // laws that were refused say nothing
    if (!chooses) parts[k].refuse({"kt"}, kWhy);
    any = any || chooses;
  }
  if (!any) macro.refuse({"kt"}, kWhy);
}

}  // namespace

MacroComparisonSetup read_macro_comparison(const Scene& scene) {
  return scene.read([&](const SceneTable& root) {
    (void)root.choice(kKindKey, {"macro-comparison"});
    MacroComparisonSetup setup;
    setup.title = root.title();
    setup.seed = static_cast<std::uint64_t>(root.count(kSeedKey, 0, 1000000000000, 1));
    setup.spec = read_soft_particle(root);
    setup.contents = root.table_or_empty("packing").count(
        {"count", "number of different packings inside the soft particles"}, 1, 100000, setup.contents);
    const SceneTable macro = root.table({"macro", "particles, preparation, test and twins that all scenes share"});
    MacroSetup base = read_macro_setup(macro, setup.spec);
    const bool modulus_is_known = !root.table_or_empty("material").has_errors();
    read_stages(root, macro, base.spec, modulus_is_known);
    require_own_preparation(macro, base);
    if (!macro.has("resolved")) base.twins = {Twin::shelled, Twin::free};
    base.kept_states = read_kept_states(root);
    for (const SceneTable& t : root.tables({"scene",
                                            "one scene to compare on, with the keys of `[macro]` that differ; at least "
                                            "one table, which may be empty"}))
      setup.scenes.push_back(
          read_scene(root, t, base, setup.spec, setup.scenes, setup.seed, !root.has_errors(), modulus_is_known));
    refuse_idle_stages(root, "scene", root.tables("scene"));
    std::vector<const MacroSpec*> tests;
    std::vector<const MacroSetup*> setups;
    for (const ComparisonScene& s : setup.scenes) {
      tests.push_back(&s.setup.spec);
      setups.push_back(&s.setup);
    }
    if (!tests.empty()) {
      refuse_idle_test_keys(macro, root, tests);
      refuse_idle_sizes(macro, setups);
      const auto any = [&](auto&& has) { return std::any_of(setup.scenes.begin(), setup.scenes.end(), has); };
      refuse_idle_keys(macro, any([](const ComparisonScene& s) { return !s.setup.twins.empty(); }),
                       any([](const ComparisonScene& s) { return s.setup.bands > 0; }));
      if (!any([](const ComparisonScene& s) { return !s.setup.twins.empty(); }))
        root.table_or_empty("material").refuse({"restitution"}, "goes with twins, which no [[scene]] has");
      if (macro.has("solid_fill") &&
          !any([](const ComparisonScene& s) { return s.setup.spec.construction == Construction::voids; }))
        macro.add_error("solid_fill", "goes with construction = \"voids\", which no [[scene]] has");
    }
    const std::vector<SceneTable> parts = root.tables("scene");
    for (std::size_t k = 0; k < parts.size(); ++k)
      if (parts[k].has("law"))
        parts[k]
            .table({"law", "law of this scene, with the keys of `[law]`, instead of the common `[law]`"})
            .section([&] { setup.scenes[k].laws = read_law_sources(scene, parts[k].table("law")); });
    if (setup.scenes.empty())
      root.add_error("scene", "no [[scene]] to compare on; an empty one takes all from [macro]");
    const bool all_own = !setup.scenes.empty() && std::all_of(setup.scenes.begin(), setup.scenes.end(),
                                                              [](const ComparisonScene& s) { return s.laws; });
    if (all_own && root.has("law"))
      root.add_error("law", "every [[scene]] has a law of its own");
    else if (!all_own)
      root.table({"law", "laws to compare: `table`, `card` or both; refused if every scene has its own law"})
          .section([&] { setup.laws = read_law_sources(scene, root.table("law")); });
    refuse_idle_slopes(setup, macro, parts);
    return setup;
  });
}

using nlohmann::json;

void check_macro_comparison(const MacroComparisonSetup& setup, Findings& out) {
  out.lines += fmt::format("  comparison of laws with twins on {}\n", counted(setup.scenes.size(), "scene"));
  const MacroContent content = content_of(setup.spec, setup.contents, setup.seed);
  out.add("solid_fraction", content.solid_fraction,
          fmt::format("solid fraction of the contents: {:.3f}", content.solid_fraction));
  json scenes = json::array();
  for (const ComparisonScene& s : setup.scenes) {
    const json common = std::exchange(out.facts, json{{"name", s.name}});
    out.lines += "  scene " + s.name + ":\n";
    add_sizes(out, drawn_sizes(s.setup, setup.seed));
    check_macro(s.setup, s.by_own_law() ? MacroContent{} : content, &setup.laws_of(s), setup.seed, out);
    scenes.push_back(std::exchange(out.facts, common));
  }
  out.facts["scenes"] = scenes;
  warn_of_soft_particle(setup.spec, out);
}

}  // namespace softgrain
