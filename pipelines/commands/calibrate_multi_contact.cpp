#include "pipelines/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/contact/make_laws.h"
#include "common/io/hdf5_file.h"
#include "pipelines/kinds/law_table/multi_contact_law_fit.h"
#include "pipelines/kinds/law_table/multi_contact_summary.h"
#include "pipelines/report/report.h"
#include "pipelines/results/summary.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;

struct MultiContactSettings {
  MultiContactFitOptions fit;
  double target = MultiContactSetup{}.target;
};

MultiContactSettings read_multi_contact_settings(const SceneTable& t) {
  MultiContactSettings s;
  s.fit = read_multi_contact_fit(t);
  s.target = t.number("target", Unit::none, Range{0.0, 1.0, true, false}, s.target);
  t.finish();
  return s;
}

/// Whether the first measurement, which the report draws beside its laws, lies in the run directory already.
bool is_kept(const std::string& path, const std::string& source) {
  std::error_code not_there;
  return fs::equivalent(path, source, not_there);
}

void keep_for_report(const MultiContactMeasurements& data, const std::string& source, const RunContext& context,
                     const Provenance& provenance) {
  const std::string path = context.path(kMultiContactFile);
  if (!is_kept(path, source)) save_multi_contact(data, path, provenance);
}

nlohmann::json summarise(const MultiContactLawFit& fit, const std::vector<MultiContactMeasurements>& data,
                         const MultiContactSettings& settings, const CommonOptions& options,
                         const RunContext& context) {
  nlohmann::json summary;
  summary["status"] = to_string(fit.usable ? RunStatus::good : RunStatus::not_usable);
  summary["inputs"] = options.inputs;
  summary["multi_contact"] = json_of(summary_of(data.front(), settings.target));
  summary["entries"] = json_of(summaries_of(fit.table));
  summary["options"] = {{"discrepancy", settings.fit.discrepancy},
                        {"replicates", settings.fit.replicates},
                        {"min_packings", settings.fit.min_packings},
                        {"largest_error", settings.fit.largest_error},
                        {"target", settings.target},
                        {"seed", settings.fit.seed}};
  summary["remarks"] = fit.remarks;
  for (const char* file : {kMultiContactFile, "law_table.toml", "law_table.h5", "report.html"})
    summary["files"][file] = context.path(file);
  return summary;
}

std::string console_summary(const MultiContactLawFit& fit, const RunContext& context) {
  std::string text = entries_text(fit.table);
  return text + fmt::format("law table: {}; report: {}", context.path("law_table.toml"), context.path("report.html"));
}

}  // namespace

bool are_multi_contact_files(const std::vector<std::string>& files) {
  const auto multi_contact = std::count_if(
      files.begin(), files.end(), [](const std::string& file) { return h5::open_file(file).has("configurations"); });
  if (multi_contact != 0 && multi_contact != static_cast<std::ptrdiff_t>(files.size()))
    throw InputError("calibrate: measurements of one contact and of several at once need a run each: " + files.front() +
                     " and others");
  return multi_contact != 0;
}

ExitStatus calibrate_multi_contact(const CommonOptions& options) {
  const Scene scene = Scene::parse("", "calibrate", options.overrides);
  MultiContactSettings settings = scene.read(read_multi_contact_settings);
  std::vector<MultiContactMeasurements> data;
  for (const std::string& file : options.inputs) data.push_back(load_multi_contact(file));
  std::vector<std::string> written{"law_table.h5"};
  const std::string kept = calibrate_directory(options) + "/" + kMultiContactFile;
  if (!is_kept(kept, options.inputs.front())) written.emplace_back(kMultiContactFile);
  require_inputs_stay(options, written);
  const RunContext context(options, "calibrate", calibrate_name(options));
  settings.fit.seed = context.seed(settings.fit.seed);
  const Provenance provenance = context.provenance(scene, settings.fit.seed);
  MultiContactLawFit fit;
  context.guard(provenance, [&] {
    for (const MultiContactMeasurements& d : data) {
      add_entry(fit, d, settings.fit, settings.target);
      if (fit.table.entries.size() == 1) fit.table.entries.front().main = true;
    }
  });
  save_law_table(fit.table, context.path("law_table.toml"), provenance);
  keep_for_report(data.front(), options.inputs.front(), context, provenance);
  context.finish(summarise(fit, data, settings, options, context), provenance, console_summary(fit, context));
  write_report(context.directory());
  return fit.usable ? ExitStatus::good : ExitStatus::not_usable;
}

}  // namespace softgrain
