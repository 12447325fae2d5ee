#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/io/text_file.h"
#include "pipelines/kinds/material/run.h"
#include "pipelines/kinds/material_models/models.h"
#include "pipelines/kinds/material_models/scene.h"
#include "pipelines/run/typed_kind.h"

namespace softgrain {

namespace {

bool among(const std::vector<std::string>& names, const MaterialVariant& v) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) { return is_named(v, name); });
}

/// Every model of every variant; curves to models_VARIANT.h5.
std::vector<ModelScore> run_models(const MaterialModelsScene& scene, const std::vector<VariantResult>& truths,
                                   const Run& run) {
  std::vector<ModelScore> scores;
  for (const VariantResult& truth : truths) {
    std::vector<MacroCurve> curves;
    SubstituteRuns substitutes;
    for (const MaterialModel& model : scene.models) {
      if (!model.variants.empty() && !among(model.variants, *truth.variant)) continue;
      const ModelRun one = run_model(model, truth, run, substitutes);
      scores.push_back(score(one, among(scene.blind, *truth.variant)));
      curves.insert(curves.end(), one.curves.begin(), one.curves.end());
    }
    if (!curves.empty()) save_macro(curves, run.path("models_" + truth.variant->name + ".h5"), run.provenance);
  }
  return scores;
}

/// A run whose models all fail compares nothing.
void reject_models_without_curves(const std::vector<ModelScore>& scores, SummaryHead& head) {
  if (scores.empty() || std::ranges::any_of(scores, [](const ModelScore& s) { return s.samples > 0; })) return;
  head.mark_unusable("no model has a curve: " + scores.front().remark);
}

RunInputs inputs_of(const MaterialModelsScene& scene) {
  return {scene.material.seed, scene.files, scene.text + sizes_text(scene.material)};
}

Outcome run_material_models(const MaterialModelsScene& scene, const Run& run) {
  const VariantRuns measured_variants = run_variants(scene.material, run, {.packings = true});
  const std::vector<VariantResult>& truths = measured_variants.results;
  MaterialOutcome measured = summarise(scene.material, truths, run);
  reject_failures(measured_variants.failures, measured.summary.head);
  write_text_atomic(run.path("material.csv"), as_csv(points_of(truths)));
  MaterialModelsSummary summary{std::move(measured.summary), {}};
  run.guard([&] { summary.scores = run_models(scene, truths, run); });
  reject_models_without_curves(summary.scores, summary.material.head);
  write_text_atomic(run.path("models.csv"), as_csv(table_of(summary.scores)));
  summary.material.head.files["models"] = run.path("models.csv");
  return {json_of(summary), console_summary(summary.material) + console_summary(summary.scores)};
}

void check_models(const MaterialModelsScene& scene, Findings& out) {
  check_variants(scene.material, out);
  if (!scene.models.empty()) out.lines += "  the time of the models is not in what is said below\n";
  for (const MaterialModel& m : scene.models) {
    out.lines +=
        fmt::format("  model {}: {}{}\n", m.name, to_string(m.kind),
                    m.bands > 0 ? fmt::format(", and once more for each of {} draws of its card", m.bands) : "");
    std::set<std::string> others;
    for (const MaterialVariant& v : scene.material.variants)
      if (m.variants.empty() || among(m.variants, v)) others.insert(other_fines(m, v.setup.spec));
    for (const std::string& text : others)
      if (!text.empty()) out.lines += "    " + text + "\n";
  }
}

/// As SceneKind::starter.
constexpr const char* kMaterialModelsStarter = R"(title = "A resolved material and two models of it"
seed = 1
samples = 2
[grains]
count = 120
ratio = 2.0
[packing]
preparation = "fast"
[test]
steps = 3
strain = 0.05
[[model]]
name = "substitute"
kind = "substitute"
split = 0.8
smallest = 0.6
[[model]]
name = "coarse"
kind = "coarse"
split = 0.8
)";

}  // namespace

SceneKind material_models_kind() {
  return scene_kind(TypedKind<MaterialModelsScene>{
      .name = "material-models",
      .command = "run",
      .read = read_material_models_scene,
      .inputs = inputs_of,
      .run = run_material_models,
      .check = check_models,
      .results = material_models_results(),
      .summary = members_of<MaterialModelsSummary>,
      .keeps = {.measurements = true, .packings = true},
      .explored_from = {"", explored_stages(), explored_stages("loading"), explored_stages("variant")},
      .starter = kMaterialModelsStarter});
}

}  // namespace softgrain
