#include "pipelines/kinds/law_table/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "common/contact/crowd_table_file.h"
#include "pipelines/kinds/law_table/crowd_plan.h"
#include "pipelines/kinds/law_table/crowd_stage.h"
#include "pipelines/kinds/law_table/crowd_summary.h"
#include "pipelines/kinds/law_table/results.h"
#include "pipelines/results/summary.h"
#include "pipelines/run/run.h"
#include "pipelines/run/size_summary.h"

namespace softgrain {

namespace {

/// Everything a run leaves behind, for summary and screen.
struct LawTableRun {
  CrowdMeasurements data;
  CrowdLawFit fit;
};

LawTableRun measure_and_fit(const LawTableSetup& setup, const Run& run) {
  LawTableRun result;
  CrowdFitOptions fit = setup.fit;
  fit.seed = run.seed;
  std::vector<ShellPacking> packings;
  result.data = run_crowd_stage(setup.crowd, run, result.fit.remarks, packings);
  add_entry(result.fit, result.data, fit, setup.crowd.target);
  result.fit.table.entries.front().main = true;
  for (std::size_t k = 0; k < setup.variants.size(); ++k) {
    const LawTableVariant& v = setup.variants[k];
    run.context.say(fmt::format("variant {}: beta = {}, {} trials", k + 1, v.spec.beta, v.spec.trials));
    CrowdLevel named;  // nothing inside the soft particles, but a file of its own
    named.file = fmt::format("crowd_variant_{}.h5", k + 1);
    packings.clear();
    add_entry(result.fit, run_crowd_stage(setup_of(v, setup.crowd), run, result.fit.remarks, packings, &named), fit,
              setup.crowd.target);
  }
  save_law_table(result.fit.table, run.path("law_table.toml"), run.provenance);
  return result;
}

nlohmann::json summarise(const LawTableSetup& setup, const LawTableRun& result, const Run& run) {
  nlohmann::json summary;
  summary["status"] = result.fit.usable ? "good" : "not usable";
  summary["title"] = setup.title;
  summary["crowd"] = crowd_json(result.data, setup.crowd.target);
  summary["entries"] = entries_json(result.fit.table);
  summary["remarks"] = result.fit.remarks;
  if (setup.crowd.spec.sizes)
    summary["sizes"] = json_of(summaries_of(shell_sizes(setup.crowd.spec, result.data.packings)));
  for (const char* file : {"crowd.h5", "law_table.toml", "law_table.h5", "report.html"})
    summary["files"][file] = run.path(file);
  return summary;
}

std::string people_text(const LawTableRun& result, const Run& run) {
  std::string text =
      fmt::format("{} configurations, {} runs:\n", result.data.configurations.size(), result.data.runs.size());
  text += crowd_text(result.data);
  text += entries_text(result.fit.table);
  return text + "law table: " + run.path("law_table.toml") + "\n";
}

ExitStatus run_law_table(const Scene& scene, const CommonOptions& options) {
  const LawTableSetup setup = read_law_table(scene);
  const Run run(scene, options, "run", setup.crowd.seed, {.text = sizes_text(setup.crowd.spec)});
  LawTableRun result;
  run.context.guard([&] { result = measure_and_fit(setup, run); });
  return run.finish(summarise(setup, result, run), people_text(result, run));
}

}  // namespace

SceneKind law_table_kind() {
  return {.name = "law-table",
          .command = "run",
          .run = run_law_table,
          .check = [](const Scene& scene, const std::string&, Findings& out) { check_law_table(scene, out); },
          .read = [](const Scene& scene) { (void)read_law_table(scene); },
          .results = law_table_results()};
}

}  // namespace softgrain
