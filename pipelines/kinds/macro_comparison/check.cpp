// softgrain check of comparisons of laws with twins.
#include <fmt/format.h>

#include <utility>

#include "pipelines/kinds/macro/check.h"
#include "pipelines/kinds/macro/stage.h"
#include "pipelines/kinds/macro_comparison/scene.h"
#include "pipelines/kinds/soft_particle/check.h"

namespace softgrain {

using nlohmann::json;

void check_macro_comparison(const MacroComparisonSetup& setup, Findings& out) {
  out.lines += fmt::format("  comparison of laws with twins on {} scenes\n", setup.scenes.size());
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
