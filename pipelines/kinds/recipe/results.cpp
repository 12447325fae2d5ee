#include <fmt/format.h>

#include "common/data/law_words.h"
#include "pipelines/kinds/law_table/law_check.h"
#include "pipelines/kinds/material_law/results.h"
#include "pipelines/kinds/recipe/run.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"

namespace softgrain {

namespace {

std::vector<HeadLine> lines_of(const report::RunData& run) {
  const auto r = run.summary_as<RecipeSummary>().recipe;
  if (r.levels.empty() || !r.onset) return {};
  return {{"Recipe", fmt::format("{} levels, largest over smallest {}; begins to carry pressure at a solid fraction of "
                                 "{}; a cubic metre holds {} "
                                 "grains.",
                                 r.levels.size(), report::format_number(r.span, 3), interval_text(*r.onset),
                                 report::format_number(r.grains_per_cubic_metre, 2))}};
}

std::vector<RunValue> values_of(const report::RunData& run) {
  const auto r = run.summary_as<RecipeSummary>().recipe;
  std::vector<RunValue> out;
  if (r.onset) out.push_back({"onset of the whole", "", r.onset->value, r.onset->standard_error});
  for (const RecipeCurve& c : r.curves)
    if (!c.axial.empty()) out.push_back({"axial stress over E at the end, " + c.name, "", c.axial.back()});
  for (const RecipeCurve& c : r.curves)
    if (c.modulus) out.push_back({"constrained modulus over E, " + c.name, "", c.modulus->value});
  return out;
}

std::vector<RunCurve> curves_of(const report::RunData& run) {
  std::vector<RunCurve> out;
  for (const RecipeCurve& c : run.summary_as<RecipeSummary>().recipe.curves)
    if (!c.strain.empty()) {
      RunCurve curve;
      curve.plot = "Recipe under oedometric load";
      curve.x_label = "axial strain";
      curve.y_label = "axial stress over E";
      curve.name = c.name;
      curve.x = c.strain;
      curve.y = c.axial;
      out.push_back(std::move(curve));
    }
  return out;
}

NextSteps next_of(const report::RunData& run) {
  return {"The coarsest level among all finer ones in a scene of your own: `softgrain macrosim SCENE.toml --law " +
              run.directory + "/cell_law.toml`.",
          "How far from converged: `softgrain run SCENE.toml --set samples=4 --set grains.count=4000`; how far the law "
          "holds: a larger check, `--set check.grains=80000`."};
}

}  // namespace

KindResults recipe_results() {
  return {.files = {{.names = "recipe(\\.csv|_macro\\.h5)"}, {.names = "material_card\\.toml", .check = check_laws}},
          .sections = {{Part::several, report::recipe_section}},
          .lines = lines_of,
          .values = values_of,
          .curves = curves_of,
          .next = next_of};
}

}  // namespace softgrain
