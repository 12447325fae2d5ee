#include "pipelines/kinds/law_table/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "common/contact/crowd_table_file.h"
#include "pipelines/kinds/law_table/crowd_plan.h"
#include "pipelines/kinds/law_table/crowd_stage.h"
#include "pipelines/kinds/law_table/crowd_summary.h"
#include "pipelines/kinds/law_table/scene.h"
#include "pipelines/report/report.h"
#include "pipelines/run/run_summary.h"

namespace softgrain {

namespace {

/// Configurations that only test the law are left to the main measurement.
CrowdSetup setup_of(const LawTableVariant& variant, const CrowdSetup& base) {
  CrowdSetup setup = base;
  setup.spec = variant.spec;
  setup.packings_min = setup.packings_max = variant.packings;
  std::erase_if(setup.configurations, [&](const CrowdConfiguration& c) {
    const auto softs = std::count_if(c.partners.begin(), c.partners.end(),
                                     [](const CrowdPartner& p) { return p.kind == PartnerKind::soft; });
    return c.held_out || c.centre_free || softs >= setup.packings_max;
  });
  return setup;
}

/// Everything a run leaves behind, for summary and screen.
struct LawTableRun {
  CrowdMeasurements data;
  CrowdLawFit fit;
};

LawTableRun measure_and_fit(const LawTableSetup& setup, const TaskStore& store, const RunContext& context,
                            const Provenance& provenance) {
  LawTableRun run;
  CrowdFitOptions fit = setup.fit;
  fit.seed = context.seed(setup.crowd.seed);
  run.data = run_crowd_stage(setup.crowd, store, context, provenance, run.fit.remarks, nullptr);
  add_entry(run.fit, run.data, fit, setup.crowd.target);
  run.fit.table.entries.front().main = true;
  for (std::size_t k = 0; k < setup.variants.size(); ++k) {
    const LawTableVariant& v = setup.variants[k];
    context.say(fmt::format("variant {}: beta = {}, {} trials", k + 1, v.spec.beta, v.spec.trials));
    CrowdLevel named;  // nothing inside the soft particles, but a file of its own
    named.file = fmt::format("crowd_variant_{}.h5", k + 1);
    add_entry(run.fit,
              run_crowd_stage(setup_of(v, setup.crowd), store, context, provenance, run.fit.remarks, nullptr, &named),
              fit, setup.crowd.target);
  }
  save_law_table(run.fit.table, context.path("law_table.toml"), provenance);
  return run;
}

nlohmann::json summarise(const LawTableSetup& setup, const LawTableRun& run, const RunContext& context,
                         const Provenance& provenance, double seconds) {
  nlohmann::json summary;
  summary["status"] = run.fit.usable ? "good" : "not usable";
  summary["title"] = setup.title;
  summary["seconds"] = seconds;
  summary["crowd"] = crowd_json(run.data, setup.crowd.target);
  summary["entries"] = entries_json(run.fit.table);
  summary["remarks"] = run.fit.remarks;
  for (const char* file : {"crowd.h5", "law_table.toml", "law_table.h5", "report.html"})
    summary["files"][file] = context.path(file);
  summary["provenance"] = provenance_json(provenance);
  return summary;
}

std::string people_text(const LawTableRun& run, const RunContext& context, double seconds) {
  std::string text = fmt::format("{} configurations, {} runs:\n", run.data.configurations.size(), run.data.runs.size());
  text += crowd_text(run.data);
  text += entries_text(run.fit.table);
  for (const std::string& remark : run.fit.remarks) text += "note: " + remark + "\n";
  return text + fmt::format("{:.0f} s; law table: {}; report: {}", seconds, context.path("law_table.toml"),
                            context.path("report.html"));
}

ExitStatus run_law_table(const Scene& scene, const CommonOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const LawTableSetup setup = read_law_table(scene);
  const RunContext context(options, "run", std::filesystem::path(scene.path()).stem().string());
  const std::uint64_t seed = context.seed(setup.crowd.seed);
  const Provenance provenance = context.provenance(scene, seed);
  const TaskStore store(context, scene, seed);
  LawTableRun run;
  context.guard([&] { run = measure_and_fit(setup, store, context, provenance); });
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  context.finish(summarise(setup, run, context, provenance, seconds), people_text(run, context, seconds));
  write_report(context.directory());
  store.clear();
  return run.fit.usable ? ExitStatus::good : ExitStatus::not_usable;
}

}  // namespace

SceneKind law_table_kind() {
  return {.name = "law-table",
          .command = "run",
          .run = run_law_table,
          .check = [](const Scene& scene, const std::string&, Findings& out) { check_law_table(scene, out); },
          .read = [](const Scene& scene) { (void)read_law_table(scene); }};
}

}  // namespace softgrain
