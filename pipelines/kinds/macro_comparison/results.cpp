#include "pipelines/kinds/macro_comparison/results.h"

#include <fmt/format.h>

#include "pipelines/compare/macro_scores.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/run_data.h"

namespace softgrain {

namespace {

using namespace report;

/// The law that comes closest to the shelled twin.
std::string scene_line(const ComparedCurves& scene) {
  const std::vector<EngineScore> scores = score_engines(scene.curves);
  const EngineScore* best = nullptr;
  for (const EngineScore& s : scores) {
    if (headline_of(s.shelled).value.n == 0 || s.twin()) continue;
    if (best == nullptr || headline_of(s.shelled).value.mean < headline_of(best->shelled).value.mean) best = &s;
  }
  if (best == nullptr) return "";
  const ComparedQuantity off = headline_of(best->shelled);
  const MeanError& unloading = best->shelled.unloading;
  return fmt::format(
      "{}: the {} comes closest, {} off by {} % from the shelled twin{}; {} times fewer contact evaluations.",
      scene.name, engine_name(best->engine), off.what,
      format_with_error(100.0 * off.value.mean, 100.0 * off.value.error),
      unloading.n > 0 ? ", unloading modulus " + format_with_error(unloading.mean, unloading.error) + " times its own"
                      : "",
      format_number(best->shelled.speedup_evaluations, 3));
}

std::vector<HeadLine> lines_of(const RunData& run) {
  std::vector<HeadLine> lines;
  for (const ComparedCurves& scene : run.macro_scenes) lines.emplace_back(kResultLabel, scene_line(scene));
  return lines;
}

std::vector<RunValue> values_of(const RunData& run) {
  std::vector<RunValue> out;
  for (const ComparedCurves& scene : run.macro_scenes)
    for (const EngineScore& s : score_engines(scene.curves))
      if (const auto [what, off, ratio] = headline_of(s.shelled); off.n > 0 && !s.twin())
        out.push_back({fmt::format("{} off from the twin ({}, {})", what, scene.name, s.engine), "%", 100.0 * off.mean,
                       100.0 * off.error});
  return out;
}

NextSteps next_of(const RunData&) {
  return {
      "Take the law that comes closest in scenes like these: `softgrain macrosim SCENE.toml --law LAW_TABLE.toml --set "
      "form=NAME`.",
      "What to measure next for it: `softgrain law plan LAW_TABLE.toml --for SCENE.toml`; twins are kept for other "
      "laws by `--twin-cache DIR`."};
}

}  // namespace

KindResults macro_comparison_results() {
  return {.files = {{.names = "comparison\\.json"}, {.names = "(macro|states_macro)_.+\\.h5", .says_so = true}},
          .sections = {{Part::several, macro_scenes_section}},
          .lines = lines_of,
          .values = values_of,
          .next = next_of};
}

}  // namespace softgrain
