#include "pipelines/kinds/hierarchy/scene.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>

#include "common/contact/make_laws.h"
#include "common/core/text.h"
#include "pipelines/kinds/hierarchy/level.h"
#include "pipelines/kinds/hierarchy/summary.h"
#include "pipelines/kinds/law_table/multi_contact_summary.h"
#include "pipelines/report/run_data.h"
#include "pipelines/run/size_summary.h"
#include "pipelines/run/typed_kind.h"

namespace softgrain {

namespace {

struct HierarchyRun {
  std::vector<HierarchyLevel> levels;  ///< the finest first
  std::optional<std::int64_t> fixed;   ///< level at which the law stopped changing
  std::optional<CheckResult> check;
  std::vector<std::string> remarks;
  bool usable = true;
};

/// The law no longer changes by more than the tolerance, or by more than packings alone would make of it.
bool at_rest(const HierarchySetup& setup, const HierarchyLevel& level) {
  return level.number > 0 && level.distance <= std::max(setup.tolerance, level.distance_noise);
}

void run_levels(const HierarchySetup& setup, const Run& run, HierarchyRun& result) {
  MultiContactMeasurements below;
  LevelContents contents(setup, run.seed);
  for (std::int64_t k = 0; k < setup.iterations; ++k) {
    if (k >= setup.levels && result.fixed) break;
    run.context.say(k == 0 ? "level 0: grains only" : fmt::format("level {}: on top of the law of level {}", k, k - 1));
    MultiContactMeasurements data;
    const HierarchyLevel* last = result.levels.empty() ? nullptr : &result.levels.back();
    HierarchyLevel level = run_level(setup, contents, k, last, &below, data, run);
    for (const std::string& r : multi_contact_remarks(data, setup.multi_contact.target))
      result.remarks.push_back(fmt::format("level {}: {}", k, r));
    for (const std::string& text : level.left_out) result.remarks.push_back(fmt::format("level {}: {}", k, text));
    const MultiContactLaw& law = *level.entry.find(setup.form);
    save_law_table({1, {level.entry}}, run.path(fmt::format("law_table_level_{}.toml", k)), run.provenance);
    if (law.status == LawStatus::no_threshold_crossing)
      throw UnusableResult(fmt::format("level {}: its law never crosses its threshold ({})", k, law.reason));
    if (law.status != LawStatus::good) {
      result.usable = false;
      result.remarks.push_back(
          fmt::format("level {}: {} law: {}: {}", k, to_string(setup.form), to_string(law.status), law.reason));
    }
    if (!result.fixed && at_rest(setup, level)) result.fixed = k;
    if (k > 0)
      run.context.say(fmt::format("level {}: the law differs by {:.1f} % from the one below (packings alone: {:.1f} %)",
                                  k, 100.0 * level.distance, 100.0 * level.distance_noise));
    result.levels.push_back(std::move(level));
    below = std::move(data);
  }
  save_law_table({1, {result.levels.back().entry}}, run.path("law_table.toml"), run.provenance);
}

/// Forces of one plane and of six, per plane, over overlap.
LevelCurves curves_of(const HierarchyLevel& level, LawForm form) {
  const MultiContactModel model = multi_contact_model(*level.entry.find(form));
  const std::vector<MultiContactPartner> cube = six_planes();
  LevelCurves out;
  for (int k = 1; k <= 50; ++k) {
    const double x = level.entry.overlap_max * k / 50.0;
    out.overlap.push_back(x);
    out.one.push_back(multi_contact_forces(model, {cube[0]}, {x})[0]);
    out.cube.push_back(multi_contact_forces(model, cube, std::vector<double>(6, x))[0]);
  }
  return out;
}

/// `grains_below`: share of the shell that the grains of the level below take up in theirs.
LevelSummary summary_of(const HierarchyLevel& level, double grains_below, LawForm form) {
  const MultiContactLaw& law = *level.entry.find(form);
  LevelSummary out;
  out.level = level.number;
  out.law = {law.status, law.error_cross, {}};
  for (std::size_t k = 0; k < kMultiContactParameters.size(); ++k)
    out.law.parameters[k] = (law.*kMultiContactParameters[k].estimate).value;
  out.resolved_grains = level.grains;
  out.cost = level.cost;
  out.cost.seconds = level.seconds;
  out.curves = curves_of(level, form);
  out.grain_percent = 100.0 * level.grain_volume;
  out.solid_percent = 100.0 * level.entry.solid_fraction;
  if (!std::isnan(level.error)) out.error_percent = 100.0 * level.error;
  if (level.number == 0) return out;
  out.inner = {level.inner_mean, level.inner_low, level.inner_high, 100.0 * level.inner_volume,
               level.inner_volume * grains_below / level.grain_volume};
  out.distance_percent = 100.0 * level.distance;
  out.noise_percent = 100.0 * level.distance_noise;
  if (!std::isnan(level.own_error)) out.own_error_percent = 100.0 * level.own_error;
  out.sensitivity = level.sensitivity;
  out.changes = level.changes;
  return out;
}

std::string check_text(const CheckResult& check) {
  return fmt::format(
      "Two decades checked with all their grains: {:.0f} inner soft particles, {:.0f} grains on average, {}; "
      "{:.0f} times fewer contact evaluations by law.",
      check.inner, check.grains, counted(check.packings, "packing"),
      static_cast<double>(check.resolved_cost.contact_evaluations) /
          static_cast<double>(std::max<std::int64_t>(check.law_cost.contact_evaluations, 1)));
}

/// Radii from the largest grain of the coarsest level down to the smallest of the finest one, largest over smallest.
double span(const HierarchySetup& setup, const HierarchyRun& result, std::int64_t levels) {
  double inner = 0.0;  // mean radius of an inner soft particle over that of its parent
  for (const HierarchyLevel& l : result.levels)
    if (l.number > 0) inner = 0.5 * (l.inner_low + l.inner_high);
  return setup.multi_contact.spec.polydispersity * std::pow(1.0 / inner, static_cast<double>(levels - 1));
}

std::string fixed_text(const HierarchySetup& setup, const HierarchyRun& result) {
  const HierarchyLevel& coarsest = result.levels[static_cast<std::size_t>(setup.levels - 1)];
  std::string text =
      fmt::format("{} levels: radii 1 to {:.2g}; a soft particle of the coarsest level stands for {:.3g} grains. ",
                  setup.levels, span(setup, result, setup.levels), coarsest.grains);
  if (result.fixed)
    return text + fmt::format(
                      "From level {} on the law no longer changes (by {:.2f} %; limit {:.2f} %, or what packings "
                      "alone make of it, {:.2f} %): the fixed point of an unbounded hierarchy.",
                      *result.fixed, 100.0 * result.levels[static_cast<std::size_t>(*result.fixed)].distance,
                      100.0 * setup.tolerance,
                      100.0 * result.levels[static_cast<std::size_t>(*result.fixed)].distance_noise);
  return text + fmt::format(
                    "The law still changes from level to level: that of level {} differs by {:.3g} % from the one "
                    "below.",
                    result.levels.back().number, 100.0 * result.levels.back().distance);
}

HierarchySummary summarise(const HierarchySetup& setup, const HierarchyRun& result, const Run& run) {
  HierarchySummary s;
  s.head = {result.usable ? RunStatus::good : RunStatus::not_usable, setup.title, result.remarks, {}};
  for (const char* file : {"multi_contact_level_0.h5", "law_table.toml", "report.html"})
    s.head.files[file] = run.path(file);
  double evaluations = 0.0;
  for (const HierarchyLevel& l : result.levels) {
    const double below = s.levels.empty() ? 0.0 : s.levels.back().grain_percent / 100.0;
    s.levels.push_back(summary_of(l, below, setup.form));
    evaluations += static_cast<double>(l.cost.contact_evaluations);
  }
  const HierarchyLevel& finest = result.levels.front();
  const HierarchyLevel& coarsest = result.levels[static_cast<std::size_t>(setup.levels - 1)];
  s.four_decades = {setup.levels, span(setup, result, setup.levels), coarsest.grains,
                    static_cast<double>(finest.cost.contact_evaluations) * coarsest.grains / finest.grains,
                    evaluations};
  s.fixed_point = {result.fixed.has_value(), fixed_text(setup, result), result.fixed};
  if (result.check) s.check = {*result.check, check_text(*result.check)};
  return s;
}

std::string console_summary(const HierarchySetup& setup, const HierarchyRun& result) {
  std::string text = fixed_text(setup, result) + "\n";
  for (const HierarchyLevel& l : result.levels) {
    if (l.number == 0) continue;
    text += fmt::format("  level {}: {:.0f} soft particles inside ({:.1f} % of the volume), law changes by {:.1f} %",
                        l.number, l.inner_mean, 100.0 * l.inner_volume, 100.0 * l.distance);
    if (!l.changes.empty())
      text += fmt::format(", {} force x {:.3f}({:.3f})", l.changes[0].configuration, l.changes[0].ratio,
                          l.changes[0].error);
    text += "\n";
  }
  if (result.check) {
    text += check_text(*result.check) + "\n";
    for (const CheckPoint& p : result.check->points)
      text += fmt::format("  h/Rs = {:.3f}: law over resolved {:.3f}({:.3f})\n", p.overlap, p.ratio, p.ratio_error);
  }
  return text;
}

void check_levels(const HierarchySetup& setup, const Run& run, HierarchyRun& result) {
  if (setup.check_packings == 0) return;
  try {
    result.check = check_two_decades(setup, result.levels.front(), run);
  } catch (const UnusableResult& e) {  // the levels are kept and said
    result.usable = false;
    result.remarks.push_back("no resolved check: " + std::string(e.what()));
    return;
  }
  if (result.check->converged) return;
  result.usable = false;
  result.remarks.emplace_back("the resolved check holds states that did not converge");
}

RunInputs inputs_of(const HierarchySetup& setup) {
  return {.seed = setup.multi_contact.seed, .text = sizes_text(setup.multi_contact.spec)};
}

Outcome run_hierarchy(const HierarchySetup& setup, const Run& run) {
  HierarchyRun result;
  run.guard([&] {
    run_levels(setup, run, result);
    check_levels(setup, run, result);
  });
  if (!result.fixed && setup.seeks_fixed_point) {
    result.usable = false;
    result.remarks.emplace_back("the fixed point was not reached: allow more iterations or packings");
  }
  return {json_of(summarise(setup, result, run)), console_summary(setup, result)};
}

std::vector<HeadLine> lines_of(const report::RunData& run) {
  const auto levels = run.summary_as<HierarchySummary>().fixed_point;
  if (!levels) return {};
  return {{"Levels", levels->text}};
}

std::vector<RunValue> values_of(const report::RunData& run) {
  std::vector<RunValue> out;
  for (const LevelSummary& level : run.summary_as<HierarchySummary>().levels)
    if (level.distance_percent)
      out.push_back(
          {fmt::format("law of level {}, away from the one below", level.level), "%", *level.distance_percent});
  return out;
}

NextSteps next_of(const report::RunData& run) {
  return {"Take the law of the last level in a scene: `softgrain macrosim SCENE.toml --law " + run.directory +
              "/law_table.toml`.",
          "Whether levels differ beyond the scatter of packings: more of them (`--set multi_contact.packings_max=8`, "
          "`softgrain check` "
          "says what that takes)."};
}

/// As SceneKind::starter.
constexpr const char* kHierarchyStarter = R"(title = "Soft particles within soft particles"
seed = 1
[packing]
trials = 1000
polydispersity = 3.0
rmax_over_shell = 0.5
beta = 3.0
placement = "voids"
[multi_contact]
increment = 0.025
packings_min = 6
packings_max = 6
points = 4
[[configuration]]
arrangement = "one"
partner = "plane"
overlap = 0.3
[[configuration]]
arrangement = "one"
partner = "solid"
ratio = 1.0
overlap = 0.35
[[configuration]]
arrangement = "one"
partner = "soft"
ratio = 1.0
overlap = 0.4
[hierarchy]
levels = 2
form = "isotropic"
replicates = 10
[fixed_point]
iterations = 2
tolerance = 0.5
[check]
packings = 2
overlaps = [0.2, 0.3]
)";

}  // namespace

SceneKind hierarchy_kind() {
  return scene_kind(TypedKind<HierarchySetup>{.name = "hierarchy",
                                              .command = "run",
                                              .read = read_hierarchy_setup,
                                              .inputs = inputs_of,
                                              .run = run_hierarchy,
                                              .check = check_hierarchy,
                                              .results = {.sections = {{Part::several, report::hierarchy_section}},
                                                          .lines = lines_of,
                                                          .values = values_of,
                                                          .next = next_of},
                                              .summary = members_of<HierarchySummary>,
                                              .keeps = {.measurements = true},
                                              .explored_from = {"", kExploredConfiguration},
                                              .starter = kHierarchyStarter});
}

}  // namespace softgrain
