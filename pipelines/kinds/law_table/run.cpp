#include "pipelines/kinds/law_table/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "common/contact/make_laws.h"
#include "common/core/text.h"
#include "pipelines/kinds/law_table/multi_contact_stage.h"
#include "pipelines/kinds/law_table/multi_contact_summary.h"
#include "pipelines/results/summary.h"
#include "pipelines/run/size_summary.h"
#include "pipelines/run/typed_kind.h"

namespace softgrain {

namespace {

/// Everything a run leaves behind, for summary and screen.
struct LawTableRun {
  MultiContactMeasurements data;
  MultiContactLawFit fit;
};

LawTableRun measure_and_fit(const LawTableSetup& setup, const Run& run) {
  LawTableRun result;
  MultiContactFitOptions fit = setup.fit;
  fit.seed = run.seed;
  std::vector<ShellPacking> packings;
  result.data = run_multi_contact_stage(setup.multi_contact, run, result.fit.remarks, packings);
  std::vector<EntryMeasurements> measured;
  const auto add = [&](const MultiContactMeasurements& data) {
    const double fraction = add_entry(result.fit, data, fit, setup.multi_contact.target);
    if (setup.prior) measured.push_back({fraction, data});
  };
  add(result.data);
  result.fit.table.entries.front().main = true;
  for (std::size_t k = 0; k < setup.variants.size(); ++k) {
    const LawTableVariant& v = setup.variants[k];
    run.context.say(fmt::format("variant {}: beta = {}, {} trials", k + 1, v.spec.beta, v.spec.trials));
    MultiContactLevel named;  // nothing inside the soft particles, but a file of its own
    named.file = fmt::format("multi_contact_variant_{}.h5", k + 1);
    packings.clear();
    add(run_multi_contact_stage(setup_of(v, setup.multi_contact), run, result.fit.remarks, packings, &named));
  }
  combine_with_prior(result.fit, setup.prior, measured, fit);
  save_law_table(result.fit.table, run.path("law_table.toml"), run.provenance);
  return result;
}

LawTableSummary summarise(const LawTableSetup& setup, const LawTableRun& result, const Run& run) {
  LawTableSummary s{.status = result.fit.usable ? RunStatus::good : RunStatus::not_usable,
                    .title = setup.title,
                    .multi_contact = summary_of(result.data, setup.multi_contact.target),
                    .entries = summaries_of(result.fit.table),
                    .warnings = result.fit.warnings,
                    .remarks = result.fit.remarks};
  if (setup.multi_contact.spec.sizes)
    s.sizes = summaries_of(shell_sizes(setup.multi_contact.spec, result.data.packings));
  for (const char* file : {kMultiContactFile, "law_table.toml", "law_table.h5", "report.html"})
    s.files[file] = run.path(file);
  return s;
}

std::string console_summary(const LawTableRun& result, const Run& run) {
  std::string text = fmt::format("{}, {}:\n", counted(result.data.configurations.size(), "configuration"),
                                 counted(result.data.runs.size(), "run"));
  text += multi_contact_text(result.data);
  text += entries_text(result.fit.table);
  return text + "law table: " + run.path("law_table.toml") + "\n";
}

RunInputs inputs_of(const LawTableSetup& setup) {
  return {.seed = setup.multi_contact.seed,
          .files = setup.prior ? std::vector{setup.prior->path} : std::vector<std::string>{},
          .text = sizes_text(setup.multi_contact.spec) + (setup.prior ? setup.prior->text : "")};
}

Outcome run_law_table(const LawTableSetup& setup, const Run& run) {
  LawTableRun result;
  run.guard([&] { result = measure_and_fit(setup, run); });
  return {json_of(summarise(setup, result, run)), console_summary(result, run)};
}

/// As SceneKind::starter.
constexpr const char* kLawTableStarter = R"(title = "One soft particle between several neighbours"
seed = 1
[packing]
polydispersity = 5.0
rmax_over_shell = 0.5
beta = 3.0
placement = "voids"
[multi_contact]
increment = 0.01
packings_min = 12
packings_max = 12
points = 4
[[configuration]]
arrangement = "one"
partner = "plane"
overlap = 0.3
[[configuration]]
arrangement = "opposite"
partner = "plane"
overlap = 0.26
[[configuration]]
arrangement = "one"
partner = "soft"
ratio = 1.0
overlap = 0.4
[calibrate]
replicates = 10
)";

}  // namespace

SceneKind law_table_kind() {
  return scene_kind(TypedKind<LawTableSetup>{.name = "law-table",
                                             .command = "run",
                                             .read = read_law_table,
                                             .inputs = inputs_of,
                                             .run = run_law_table,
                                             .check = check_law_table,
                                             .results = law_table_results(),
                                             .summary = members_of<LawTableSummary>,
                                             .keeps = {.measurements = true},
                                             .explored_from = {"", kExploredConfiguration},
                                             .starter = kLawTableStarter});
}

}  // namespace softgrain
