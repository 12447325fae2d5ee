// softgrain calibrate DATA...: fits the contact laws to measurements; writes law.toml, law.h5 and summary.json.
// Files of multi-contact measurements, and those of experiments (CSV): see commands.h.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "calibrate/threshold_fit.h"
#include "common/core/text.h"
#include "common/data/measurements.h"
#include "pipelines/commands/commands.h"
#include "pipelines/law/law_fit.h"
#include "pipelines/law/law_json.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

namespace {

using nlohmann::json;

/// Settings of the command, all through --set; no scene file is needed.
FitOptions read_options(const SceneTable& t) {
  FitOptions o = read_fit_settings(t);
  o.relaxation = t.text({"relaxation", "relaxation that is fitted; needed if the files have several", "the only one"},
                        o.relaxation);
  t.finish();
  return o;
}

Measurements load_all(const std::vector<std::string>& files) {
  if (files.empty()) throw InputError("calibrate: no measurement file given (softgrain calibrate DATA.h5...)");
  std::vector<Measurements> parts;
  for (const std::string& file : files) parts.push_back(load_measurements(file));
  return merge_measurements(parts, files);
}

json reports_json(const std::vector<FitReport>& reports) {
  json out = json::object();
  for (const FitReport& r : reports)
    out[to_string(r.law.kind)] = {{"fit", r.fit_message},
                                  {"iterations", r.iterations},
                                  {"normal_points_left_out", r.normal_left_out},
                                  {"tangential_points_left_out", r.tangential_left_out},
                                  {"replicates", r.replicates.size()},
                                  {"replicates_failed", r.replicates_failed},
                                  {"replicates_at_bound", r.replicates_at_bound}};
  return out;
}

json options_json(const FitOptions& o) {
  return {{"delta_low", o.delta_low},
          {"delta_high", std::isfinite(o.delta_high) ? json(o.delta_high) : json(nullptr)},
          {"initial_angle_deg", o.initial_angle_deg},
          {"secant_angle_deg", o.secant_angle_deg ? json(*o.secant_angle_deg) : json(nullptr)},
          {"noise_floor", o.noise_floor},
          {"scatter_floor", o.scatter_floor},
          {"min_packings", o.min_packings},
          {"replicates", o.replicates},
          {"seed", o.seed}};
}

std::string console_line(const FitReport& report, const SoftParticleSpec& spec) {
  const PairLaw& law = report.law;
  const std::string line = verdict_text(law) + "\n";
  if (law.normal.b.value <= 0.0) return line;
  return line + normal_law_text(report, spec) +
         fmt::format("  {}, {}, {} left out (not converged)\n", counted(law.packings, "packing"),
                     counted(law.points, "point"), report.normal_left_out + report.tangential_left_out);
}

}  // namespace

std::string calibrate_name(const CommonOptions& options) {
  return std::filesystem::path(options.inputs.front()).stem().string();
}

std::string calibrate_directory(const CommonOptions& options) {
  return options.out.empty() ? default_directory(calibrate_name(options)) : options.out;
}

void require_inputs_stay(const CommonOptions& options, const std::vector<std::string>& written) {
  for (const std::string& name : written)
    for (const std::string& input : options.inputs) {
      std::error_code not_there;
      if (std::filesystem::equivalent(calibrate_directory(options) + "/" + name, input, not_there))
        throw InputError(fmt::format(
            "calibrate: {} is an input, and the run would write its own {} over it: give another --out", input, name));
    }
}

ExitStatus command_calibrate(const CommonOptions& options) {
  if (are_curve_files(options)) return calibrate_curves(options);
  if (are_multi_contact_files(options.inputs)) return calibrate_multi_contact(options);
  const Scene settings = Scene::parse("", "calibrate", options.overrides);
  FitOptions fit = settings.read(read_options);
  const Measurements data = load_all(options.inputs);
  require_inputs_stay(options, {"law.h5"});
  const RunContext run(options, "calibrate", calibrate_name(options));
  fit.seed = run.seed(fit.seed);
  std::vector<FitReport> reports;
  const LawCard card = calibrate(data, fit, &reports);
  save_card(card, run.path("law.toml"), run.provenance(settings, fit.seed));

  const bool good = std::all_of(card.pairs.begin(), card.pairs.end(),
                                [](const PairLaw& law) { return law.status == LawStatus::good; });
  std::string console;
  for (const FitReport& report : reports) console += console_line(report, card.spec);
  console += "law card: " + run.path("law.toml") + "\n";
  json summary = {{"status", good ? "good" : "not usable"},
                  {"inputs", options.inputs},
                  {"relaxation", card.relaxation},
                  {"turn", to_string(card.turn)},
                  {"laws", json_of(summary_of(card))},
                  {"fits", reports_json(reports)},
                  {"options", options_json(fit)}};
  run.finish(std::move(summary), console);
  return good ? ExitStatus::good : ExitStatus::not_usable;
}

}  // namespace softgrain
