// softgrain law plan: the run that it is for, and the plan for people and programs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "common/data/macro_result.h"
#include "common/io/interrupt.h"
#include "common/io/json_record.h"
#include "common/io/text_file.h"
#include "pipelines/commands/law_options.h"
#include "pipelines/compare/compare_inputs.h"
#include "pipelines/kinds/kinds.h"
#include "pipelines/kinds/law_table/law_plan.h"
#include "pipelines/kinds/law_table/scene.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/law/law_library_press.h"
#include "pipelines/results/summary.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Files of a run with macro curves: macro.h5, or one per scene of a comparison.
std::vector<std::string> curve_files(const std::string& directory) {
  std::vector<std::string> out;
  for (const fs::directory_entry& e : fs::directory_iterator(directory)) {
    const std::string name = e.path().stem().string();
    const bool curves = name == "macro" || (name.starts_with("macro_") && !holds_packings(name, "macro"));
    if (curves && e.path().extension() == ".h5") out.push_back(e.path().string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<MacroCurve> curves_in(const std::string& directory) {
  const std::vector<std::string> files = curve_files(directory);
  if (files.empty()) throw InputError("law plan: " + directory + " holds no macro.h5 or macro_SCENE.h5: no macro run");
  std::vector<MacroCurve> out;
  for (const std::string& file : files)
    for (MacroCurve& c : load_macro(file)) out.push_back(std::move(c));
  return out;
}

/// Runs the scene, or goes on with a run of it that was left; the directory.
std::string run_of(const LawOptions& o, const std::string& law) {
  const Scene scene = Scene::load(o.target);
  const SceneKind& kind = kind_of(scene);
  CommonOptions options;
  options.inputs = {o.target};
  options.out = o.out.empty() ? "results/plan_" + fs::path(o.target).stem().string() : o.out;
  options.quiet = true;
  options.command_line = o.command_line;
  if (kind.takes_law) options.law = law;
  constexpr std::int64_t kDraws = 60;
  if (kind.takes_law && read_macro_scene(scene, law).setup.bands == 0) options.bands = kDraws;
  options.resume = fs::exists(options.out + "/log.txt");
  install_interrupt_handler();
  if (const ExitStatus status = kind.run(scene, options); status != ExitStatus::good)
    throw UnusableResult("law plan: the run of " + o.target + " is not usable; see " + options.out);
  return options.out;
}

json json_of(const LawPlan& plan, const std::string& law, const std::string& run) {
  json out{{"command", "law plan"},
           {"status", "good"},
           {"file", law},
           {"run", run},
           {"engine", plan.engine},
           {"curves", plan.curves},
           {"draws", plan.draws},
           {"law_part", plan.law_part},
           {"discrepancy", plan.discrepancy},
           {"packings_at_a_time", plan.block},
           {"share", plan.share},
           {"core_seconds", plan.seconds},
           {"core_seconds_alike", std::isfinite(plan.even_seconds) ? json(plan.even_seconds) : json(nullptr)},
           {"candidates", json::array()},
           {"plan", json::array()},
           {"remarks", plan.remarks}};
  for (const PlanCandidate& c : plan.candidates)
    out["candidates"].push_back({{"configuration", c.configuration},
                                 {"depth", c.depth},
                                 {"overlap", c.overlap},
                                 {"packings", c.packings},
                                 {"scatter", c.scatter},
                                 {"measured", c.measured},
                                 {"core_seconds_per_packing", c.seconds},
                                 {"share", c.share}});
  for (const PlanStep& s : plan.steps)
    out["plan"].push_back({{"configuration", plan.candidates[s.candidate].configuration},
                           {"depth", plan.candidates[s.candidate].depth},
                           {"overlap", plan.candidates[s.candidate].overlap},
                           {"packings", s.packings},
                           {"core_seconds", s.seconds},
                           {"share", s.share}});
  return out;
}

/// The scene that a run was of, as it used it; empty where its summary does not say.
std::optional<Scene> scene_of(const std::string& run) {
  const std::string file = run + "/summary.json";
  if (!fs::exists(file)) return std::nullopt;
  const json summary = json::parse(read_text(file), nullptr, false);
  if (!summary.is_object()) return std::nullopt;
  const auto provenance = record_of<AnySummary>(summary).provenance;
  if (!provenance || provenance->scene.empty()) return std::nullopt;
  return Scene::parse(provenance->scene, file);
}

/// Whether a macro scene was run with this law, by the text of the law that the run recorded.
std::optional<bool> macro_run_of(const std::string& run, const Scene& scene, const FittedLaw& law) {
  try {
    const MacroScene macro = read_macro_scene(scene, law.path);
    return began_with(run, law.text + sizes_text(macro.setup.spec));
  } catch (const Error&) {  // files that it names by its own place cannot be found from here
    return std::nullopt;
  }
}

/// Whether the draws of a run are those of this table; empty: what the run left does not say it. A run that fitted its
/// own table has it in its directory.
std::optional<bool> is_run_of(const std::string& run, const FittedLaw& table, const std::vector<MacroCurve>& curves,
                              WantedForm form) {
  if (began_with(run, table.text) == true) return true;
  const std::optional<Scene> scene = scene_of(run);
  if (scene && std::string_view(kind_of(*scene).name) == macro_kind().name) return macro_run_of(run, *scene, table);
  const std::string own = run + "/law_table.toml";
  if (!scene || !fs::exists(own)) return std::nullopt;
  try {
    return same_draws(table, load_or_fit_law(own), curves, form);
  } catch (const InputError&) {  // one of them keeps too few draws; of this table the plan says so
    return std::nullopt;
  }
}

void require_plan_options(const LawOptions& o) {
  if (o.target.empty())
    throw InputError("law plan: give --for SCENE, a macro scene with bands, or the directory of its run");
  if (o.measure.empty())
    throw InputError("law plan: give --measure TABLE.toml, a law-table scene with what could be measured");
  if (o.packings < 1 || o.packings > 100000)
    throw InputError(fmt::format("law plan: --packings {}: must be from 1 to 100000", o.packings));
  if (!(o.narrow > 0.0) || !(o.narrow < 1.0))
    throw InputError(fmt::format("law plan: --narrow {}: must be above 0 and below 1", o.narrow));
  if (o.json && o.as_scene) throw InputError("law plan: --toml and --json are two forms of the plan: give one of them");
  if (!o.out.empty() && fs::is_directory(o.target))
    throw InputError("law plan: --out is the directory of the run of --for SCENE, and " + o.target +
                     " is a run already: leave --out out");
}

}  // namespace

ExitStatus plan_next(const LawOptions& o) {
  require_plan_options(o);
  const FittedLaw file = load_or_fit_law(o.files.front());
  if (file.table() == nullptr)
    throw InputError("law plan: " + file.path +
                     " is no law table: it has no configurations of several neighbours to plan with");
  const Scene table_scene = Scene::load(o.measure);
  const LawTableSetup candidates = read_law_table(table_scene);
  const std::string run = fs::is_directory(o.target) ? o.target : run_of(o, file.path);
  const std::vector<MacroCurve> curves = curves_in(run);
  const std::optional<bool> own = is_run_of(run, file, curves, o.form);
  if (own == false)
    throw InputError("law plan: " + run + " was run with another law than " + file.path +
                     ", and the draws of one say nothing of the other: give the law of that run, or --for SCENE to run "
                     "it with this one");
  LawPlan plan = plan_law(file, candidates.multi_contact, curves, {o.packings, o.narrow, o.form});
  if (!own)
    plan.remarks.push_back(run + " does not say which law it was run with: the plan holds if it was " + file.path);
  if (o.json)
    write_standard_output(json_of(plan, file.path, run).dump(2, ' ', false, json::error_handler_t::replace) + "\n");
  else
    write_standard_output(o.as_scene ? plan_scene_text(plan) : plan_text(plan));
  return ExitStatus::good;
}

}  // namespace softgrain
