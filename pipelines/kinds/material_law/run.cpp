#include <fmt/format.h>

#include <cmath>

#include "common/core/text.h"
#include "common/data/law_words.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/material/run.h"
#include "pipelines/kinds/material_law/fit.h"
#include "pipelines/kinds/material_law/scene.h"
#include "pipelines/run/typed_kind.h"

namespace softgrain {

namespace {

std::string law_text(const CellLawSummary& s) {
  const auto number = [](const LawNumber& n) { return fmt::format(" {} = {}", n.name, interval_text(n.estimate)); };
  std::string text = fmt::format("cell law, {} form:{}\n", to_string(s.form), join_text(s.numbers, ",", number));
  for (const LawNumber& f : s.void_ratio_factors)
    text += fmt::format("  void ratios of fines prepared '{}' over these: {}\n", f.name, interval_text(f.estimate));
  for (const MixtureSummary& m : s.mixtures)
    text += fmt::format("  V_f/V_c = {:.3g}: W/V_c = {}{}\n", m.ratio, interval_text(m.pores),
                        s.band ? fmt::format(", fitted {:.4g}", m.fitted) : "");
  if (s.usable)
    text += fmt::format("  W/V_c is {:.2g} about its form, stress ratios of the fines {:.2g} about the law\n",
                        s.excess_deviation, s.friction_deviation);
  if (!s.undetermined.empty())
    text += "  only together well determined: " +
            join_text(s.undetermined, ",", [](const std::string& one) { return " " + one; }) + "\n";
  return text;
}

RunInputs inputs_of(const MaterialLawScene& law) {
  return {.seed = law.material.seed, .text = sizes_text(law.material)};
}

Outcome run_material_law(const MaterialLawScene& law, const Run& run) {
  const auto [results, failures] = run_variants(law.material, run);
  MaterialOutcome measured = summarise(law.material, results, run);
  reject_failures(failures, measured.summary.head);
  write_text_atomic(run.path("material.csv"), as_csv(points_of(results)));
  MaterialLaw fitted;
  if (failures.empty())
    run.guard([&, &all = results] { fitted = fit_material_law(law, all, measured.states, run.seed); });
  else
    fitted.problems.push_back("not all of its packings could be measured");
  MaterialLawSummary summary{std::move(measured.summary), std::move(fitted.summary)};
  for (const std::string& problem : fitted.problems) summary.material.head.mark_unusable("no cell law: " + problem);
  if (summary.law.usable) {
    write_cell_card(fitted.card, run.path(kCellLawFile), run.provenance);
    summary.material.head.files["cell_law"] = run.path(kCellLawFile);
  }
  std::string text = console_summary(summary.material) + law_text(summary.law);
  for (const std::string& problem : fitted.problems) text += "no cell law: " + problem + "\n";
  return {json_of(summary), text};
}

/// As SceneKind::starter.
constexpr const char* kMaterialLawStarter = R"(title = "Cell law of a material of ratio 2"
seed = 1
samples = 3
[grains]
count = 300
ratio = 2.0
[law]
split = 0.7
mixtures = [0.15, 0.3, 0.5, 0.75]
cells = 40
shear_strain = 0.04
[packing]
preparation = "fast"
[test]
strain = 0.05
steps = 3
increments_per_step = 2
preload_steps = 1
)";

}  // namespace

SceneKind material_law_kind() {
  return scene_kind(TypedKind<MaterialLawScene>{.name = "material-law",
                                                .command = "run",
                                                .read = read_material_law_scene,
                                                .inputs = inputs_of,
                                                .run = run_material_law,
                                                .check = check_material_law,
                                                .results = material_law_results(),
                                                .summary = members_of<MaterialLawSummary>,
                                                .keeps = {.measurements = true, .packings = true},
                                                .starter = kMaterialLawStarter});
}

}  // namespace softgrain
