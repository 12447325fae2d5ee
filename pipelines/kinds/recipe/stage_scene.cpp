// Stages of a recipe as its scene gives them.
#include <fmt/format.h>

#include <algorithm>

#include "common/core/text.h"
#include "macrosim/test_protocol.h"
#include "pipelines/kinds/macro/stages.h"
#include "pipelines/kinds/recipe/stages.h"

namespace softgrain {

namespace {

/// Hertz contacts of a packing overlap by some 5 % there: no law of small deformation says more.
constexpr double kHighestStress = 0.01;
/// Points of the first stage that the equation of state needs.
constexpr std::int64_t kFirstSteps = 3;

/// The table of every stage: "cycles" make two of each cycle.
std::vector<SceneTable> table_of_each(const std::vector<SceneTable>& tables) {
  std::vector<SceneTable> out;
  for (const SceneTable& t : tables)
    out.insert(out.end(), t.has("count") ? static_cast<std::size_t>(2 * t.count("count", 1, 1000)) : 1U, t);
  return out;
}

void refuse_other_kinds(const std::vector<SceneTable>& tables) {
  for (const SceneTable& t : tables) {
    const std::string kind = t.text("kind");
    if (kind != "oedometric" && kind != "unload" && kind != "reload" && kind != "cycles")
      t.add_error(
          "kind",
          "a recipe is compressed without lateral strain: \"oedometric\", \"unload\", \"reload\" or \"cycles\"");
    t.refuse({"strain"},
             "a recipe compares its packings at the same stresses: give stress, and the strain is a result");
  }
}

/// Axial stress at the end of a stage; of "reload" without one that of the stage before its unloading.
double end_of(const std::vector<MacroStage>& stages, std::size_t k, double start) {
  if (const auto target = stages[k].target_stress()) return *target;
  const auto as_at = stages[k].axis[2].as_at;
  return as_at > 0 ? end_of(stages, static_cast<std::size_t>(as_at) - 1, start) : start;
}

void require_stresses(const std::vector<SceneTable>& tables, const MacroSpec& spec) {
  const std::vector<SceneTable> of = table_of_each(tables);
  const double start = least_stress(spec);
  double from = start;
  for (std::size_t k = 0; k < spec.stages.size(); ++k) {
    const StageRecord& record = spec.stages[k].record;
    const double to = end_of(spec.stages, k, start);
    if (to > kHighestStress * spec.youngs_modulus)
      of[k].add_error("stress", fmt::format("{} is beyond small deformations of grains with E = {}; allowed: up to {}",
                                            pressure_text(to), pressure_text(spec.youngs_modulus),
                                            pressure_text(kHighestStress * spec.youngs_modulus)));
    if (k == 0 && !(to > start))
      of[k].add_error("stress", fmt::format("must be above the {} at which the preparation ends ([packing] "
                                            "start_pressure; \"50 kPa\" is a pressure, a number is over E)",
                                            pressure_text(start)));
    const auto [low, high] = record.modulus_stress;
    if (high > 0.0 && (low < std::min(from, to) * (1.0 - 1e-9) || high > std::max(from, to) * (1.0 + 1e-9)))
      of[k].add_error("modulus_stress",
                      fmt::format("{} to {} is outside the stage, which goes from {} to {}", pressure_text(low),
                                  pressure_text(high), pressure_text(from), pressure_text(to)));
    from = to;
  }
  if (spec.stages.front().steps < kFirstSteps)
    of.front().add_error("steps", fmt::format("the equation of state is fitted to the first stage: {} recorded points "
                                              "at least",
                                              kFirstSteps));
}

}  // namespace

void read_recipe_stages(const SceneTable& root, MacroSpec& spec, bool modulus_is_known) {
  const SceneTable test = root.table_or_empty("test");
  read_stages(root, test, spec, modulus_is_known);
  const std::vector<SceneTable> tables = root.tables("stage");
  if (tables.empty() || root.has_errors()) return;
  if (std::ranges::all_of(tables, [](const SceneTable& t) { return t.has("modulus_stress"); }))
    test.refuse({"modulus_stress"}, "every [[stage]] gives its own");
  refuse_other_kinds(tables);
  if (!root.has_errors()) require_stresses(tables, spec);
}

void shear_at_stress(MacroSpec& spec, double shear_strain) {
  constexpr double kMeanOverAxial = 2.0 / 3.0;  // K0 = 1/2
  MacroStage preload = short_stage(spec, StageKind::isotropic, 0.0, spec.preload_steps);
  preload.record.name = "preload";
  preload.record.modulus_stress = {};
  const double mean = kMeanOverAxial * highest_stress(spec);
  preload.axis.fill({true, std::max(mean, 2.0 * least_stress(spec)), -1});
  preload.isotropic = true;
  MacroStage shear = short_stage(spec, StageKind::shear, shear_strain, spec.steps);
  shear.record.modulus_stress = {};
  spec.stages = {preload, shear};
}

double highest_stress(const MacroSpec& spec) {
  double highest = 0.0;
  if (spec.test != MacroTest::stages) return highest;
  for (std::size_t k = 0; k < spec.stages.size(); ++k)
    highest = std::max(highest, end_of(spec.stages, k, least_stress(spec)));
  return highest;
}

std::string stages_text(const MacroSpec& spec) {
  std::string text = "from " + pressure_text(least_stress(spec));
  for (std::size_t k = 0; k < spec.stages.size(); ++k)
    text += fmt::format(", {} to {}", spec.stages[k].record.name,
                        pressure_text(end_of(spec.stages, k, least_stress(spec))));
  return text;
}

}  // namespace softgrain
