#include "pipelines/kinds/pipeline/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "calibrate/threshold_fit.h"
#include "common/contact/make_laws.h"
#include "common/core/text.h"
#include "pipelines/compare/compare.h"
#include "pipelines/kinds/law_table/multi_contact_stage.h"
#include "pipelines/kinds/law_table/multi_contact_summary.h"
#include "pipelines/kinds/macro/bands.h"
#include "pipelines/kinds/macro/check.h"
#include "pipelines/kinds/macro/stage.h"
#include "pipelines/kinds/macro/summary.h"
#include "pipelines/kinds/soft_particle/check.h"
#include "pipelines/kinds/soft_particle/scene.h"
#include "pipelines/law/law_json.h"
#include "pipelines/report/run_data.h"
#include "pipelines/results/summary.h"
#include "pipelines/run/typed_kind.h"

namespace softgrain {

namespace {

std::string law_line(const PairLaw& law) {
  if (law.status == LawStatus::no_threshold_crossing || law.status == LawStatus::not_run)
    return fmt::format("{}: {} ({})", to_string(law.kind), to_string(law.status), law.reason);
  return fmt::format("{}: Fn/(E Rs^2) = {:.4g} (Delta^{:.3f} - {:.4f}^{:.3f}), Delta up to {:.2f}, {}, {}",
                     to_string(law.kind), law.normal.a.value, law.normal.b.value, law.normal.delta.value,
                     law.normal.b.value, law.delta_max, counted(law.packings, "packing"), to_string(law.status));
}

/// What the stages leave behind, for summary and screen.
struct PipelineResult {
  MeasureResult measured;
  LawCard card;
  MultiContactMeasurements multi_contact;  ///< measurements of [[configuration]]
  MultiContactLawFit multi_contact_fit;
  std::vector<MacroCurve> curves;
  std::vector<BandRecord> bands;
  std::optional<Comparison> comparison;       ///< comparison of engine "law" with its twin
  std::optional<Comparison> pair_comparison;  ///< comparison of engine "pair", where "law" is a multi-contact law
  std::vector<std::string> warnings;
  std::vector<std::string> remarks;
  bool usable = true;
};

void fit(const PipelineSetup& setup, const Run& run, PipelineResult& result) {
  FitOptions options = setup.fit;
  options.relaxation = setup.measure.relaxations().front();
  options.seed = run.seed;
  result.card = calibrate(result.measured.data, options);
  save_card(result.card, run.path("law.toml"), run.provenance);
  for (const PairLaw& law : result.card.pairs) {
    run.context.say(law_line(law));
    if (law.status == LawStatus::good) continue;
    result.usable = false;
    result.remarks.push_back(fmt::format("{} law: {}: {}", to_string(law.kind), to_string(law.status), law.reason));
  }
}

/// A small law table of this run's own, on the packings that the pair law is measured on.
void measure_table(const PipelineSetup& setup, const Run& run, PipelineResult& result) {
  if (!setup.measured_table) return;
  const MeasuredTable& wanted = *setup.measured_table;
  MultiContactLawFit& fit = result.multi_contact_fit;
  MultiContactFitOptions options = wanted.fit;
  options.seed = run.seed;
  std::string why;
  try {
    std::vector<ShellPacking> packings = result.measured.packings;
    run.guard(
        [&] { result.multi_contact = run_multi_contact_stage(wanted.multi_contact, run, fit.remarks, packings); });
    const double fraction = add_entry(fit, result.multi_contact, options, wanted.multi_contact.target);
    combine_with_prior(fit, wanted.prior, {{fraction, result.multi_contact}}, options);
  } catch (const InputError& e) {  // what is left could not be fitted
    why = e.what();
  } catch (const UnusableResult& e) {
    why = e.what();
  }
  if (!why.empty()) {  // the pair law goes on alone
    fit.remarks.push_back("no multi-contact law: " + why);
    fit.usable = false;
  } else {
    fit.table.entries.front().main = true;
    save_law_table(fit.table, run.path("law_table.toml"), run.provenance);
  }
  result.remarks.insert(result.remarks.end(), fit.remarks.begin(), fit.remarks.end());
  result.warnings.insert(result.warnings.end(), fit.warnings.begin(), fit.warnings.end());
  result.usable = result.usable && fit.usable;
}

bool has_multi_contact_law(const PipelineSetup& setup, const PipelineResult& result) {
  return setup.table || !result.multi_contact_fit.table.entries.empty();
}

/// Where the law called "law" comes from.
LawSources sources_of(const PipelineSetup& setup, const Run& run, const PipelineResult& result) {
  if (setup.table) return *setup.table;
  LawSources out;
  if (has_multi_contact_law(setup, result)) {
    out.laws = {{result.multi_contact_fit.table, run.path("law_table.toml")}};
    out.forms = {result.multi_contact_fit.table.entries.front().best};
  } else {
    out.laws = {{result.card}};
  }
  return out;
}

/// What was measured and fitted is kept and said even when no macro run can follow: false, with a remark.
bool run_macro_samples(const PipelineSetup& setup, const Run& run, PipelineResult& result) {
  std::string why;
  try {
    const double fraction = mean_solid_fraction(result.measured.packings);
    const LawSources sources = sources_of(setup, run, result);
    const bool multi_contact = has_multi_contact_law(setup, result);
    std::vector<NamedLaws> laws{pair_law_of(result.card, setup.macro->spec, multi_contact ? "pair" : "law")};
    if (multi_contact) laws.insert(laws.begin(), scene_law(sources, setup.macro->spec, fraction, "law"));
    result.curves = run_macro_stage(*setup.macro, laws, result.measured.packings, run,
                                    draws_for(*setup.macro, sources, {laws.front()}, fraction), result.bands);
    return true;
  } catch (const InputError& e) {  // a law that did not cross its threshold or could not be fitted
    why = e.what();
  } catch (const UnusableResult& e) {
    why = e.what();
  }
  result.remarks.push_back("no macro run: " + why);
  result.usable = false;
  return false;
}

std::optional<Comparison> with_twin(const std::string& engine, PipelineResult& result) {
  try {
    Comparison c = compare_curves(curves_of(result.curves, engine), curves_of(result.curves, "shelled"));
    for (const std::string& one : c.undefined) {
      result.remarks.push_back(engine + " and twin: " + one);
      result.usable = false;
    }
    return c;
  } catch (const InputError& e) {
    // No sample with two usable curves: said in the summary, what was computed is kept.
    result.remarks.push_back(engine + " and twin cannot be compared: " + e.what());
    result.usable = false;
    return std::nullopt;
  }
}

void run_macro(const PipelineSetup& setup, const Run& run, PipelineResult& result) {
  if (!setup.macro || !run_macro_samples(setup, run, result)) return;
  for (const std::string& r : macro_remarks(result.curves)) result.remarks.push_back(r);
  for (const std::string& r : macro_warnings(result.curves)) result.warnings.push_back(r);
  for (const std::string& r : first_point_remarks(setup.macro->spec, result.curves)) result.remarks.push_back(r);
  for (const MacroCurve& c : result.curves) result.usable = result.usable && c.usable;
  result.usable = result.usable && all_carry_stress(result.curves);
  if (!has_twin(*setup.macro, Twin::shelled)) return;
  result.comparison = with_twin("law", result);
  if (has_multi_contact_law(setup, result)) result.pair_comparison = with_twin("pair", result);
}

struct PipelineSummary {
  SummaryHead head;
  std::map<std::string, PairLawSummary> laws;
  MeasuredSummary measured;
  MacroSummary macro;
  std::optional<MacroSummary> pair;
  std::vector<BandRecord> bands;
  std::vector<BandedEnd> band_ends;
  std::optional<MultiContactSummary> multi_contact{};  ///< of a scene that measures a law table
  std::vector<EntrySummary> entries{};
};

void fields(auto&& visit, Of<PipelineSummary> auto& s) {
  fields(visit, s.head);
  visit("laws", s.laws, Means{"fitted laws, by kind of contact"});
  fields(visit, s.measured);
  fields(visit, s.macro);
  visit("pair", s.pair, kLeftOut, Means{"runs by the pair law, where those of `macro` are by a multi-contact law"});
  visit("bands", s.bands, Means{"bands of the laws that have error bars"});
  visit("band_ends", s.band_ends, Means{"stresses at the last point with their intervals"});
  visit("multi_contact", s.multi_contact, kLeftOut, Means{"what was measured with several neighbours at once"});
  visit("entries", s.entries, kLeftOut, Means{"laws of each kind of packing"});
}

PipelineSummary summarise(const PipelineSetup& setup, const PipelineResult& r, const Run& run) {
  PipelineSummary s;
  s.head = {r.usable ? RunStatus::good : RunStatus::not_usable, setup.title, r.remarks, {}, {}, r.warnings};
  for (const char* file : {"measurements.h5", "law.toml", "law.h5", "macro.h5", "macro_initial.h5", "report.html"})
    s.head.files[file] = run.path(file);
  if (!r.multi_contact_fit.table.entries.empty())
    for (const char* file : {kMultiContactFile, "law_table.toml", "law_table.h5"}) s.head.files[file] = run.path(file);
  s.bands = r.bands;
  s.band_ends = banded_ends(r.curves);
  s.head.sizes = summaries_of(shell_sizes(r.measured.data.spec, r.measured.data.packings));
  if (setup.macro)
    for (const SizesSummary& sizes : summaries_of(drawn_sizes(*setup.macro, run.seed))) s.head.sizes.push_back(sizes);
  s.laws = summary_of(r.card);
  s.measured = summary_of(r.measured.data, setup.measure.relaxations());
  s.measured.packings.broke_off = r.measured.left_out.size();
  s.measured.packings.seconds = r.measured.packing_seconds;
  s.measured.measurement.wall_seconds = r.measured.wall_seconds;
  s.macro.macro = summary_of(r.curves, "law");
  s.macro.resolved = summary_of(r.curves, "shelled");
  if (setup.macro && has_twin(*setup.macro, Twin::free)) s.macro.free = summary_of(r.curves, "free");
  if (r.comparison) s.macro.comparison = summary_of(*r.comparison);
  if (has_multi_contact_law(setup, r)) {
    s.pair.emplace();
    s.pair->macro = summary_of(r.curves, "pair");
    if (r.pair_comparison) s.pair->comparison = summary_of(*r.pair_comparison);
  }
  return s;
}

std::string whole_number(double x) { return rounded_text(x, {0, true}, "(undefined)"); }

std::string difference_text(const Comparison& c) {
  std::string text;
  for (const ComparedQuantity& q : headline_of(c))
    append_part(text,
                q.is_ratio ? fmt::format("{} {:.2f}", q.what, q.value.mean)
                           : fmt::format("{} differs by {} %", q.what, whole_number(100.0 * q.value.mean)),
                ", ");
  return text;
}

std::string console_summary(const PipelineSetup& setup, const PipelineResult& r) {
  std::string text = counted(r.measured.data.packings.size(), "packing") + " measured, laws fitted:\n";
  for (const PairLaw& law : r.card.pairs) text += "  " + law_line(law) + "\n";
  if (!r.multi_contact_fit.table.entries.empty()) text += entries_text(r.multi_contact_fit.table);
  const bool multi_contact = r.pair_comparison.has_value();
  if (r.comparison)
    text +=
        fmt::format("macro{} against its resolved twin: {}, {} times fewer contact evaluations, {} times less time\n",
                    !multi_contact         ? ""
                    : setup.measured_table ? ", multi-contact law (measured above),"
                                           : ", multi-contact law (from the table),",
                    difference_text(*r.comparison), whole_number(r.comparison->speedup_contact_evaluations),
                    whole_number(r.comparison->speedup_seconds));
  if (multi_contact)
    text += fmt::format("macro, pair law (as published, measured above): {}\n", difference_text(*r.pair_comparison));
  return text;
}

RunInputs inputs_of(const PipelineSetup& setup) {
  std::vector<std::string> files = setup.table ? setup.table->files() : std::vector<std::string>{};
  std::string text = sizes_text(setup.measure.spec) + (setup.macro ? sizes_text(setup.macro->spec) : "") +
                     (setup.table ? setup.table->text() : "");
  if (setup.measured_table && setup.measured_table->prior) {
    files.push_back(setup.measured_table->prior->path);
    text += setup.measured_table->prior->text;
  }
  return {setup.measure.seed, files, text};
}

Outcome run_pipeline(const PipelineSetup& setup, const Run& run) {
  PipelineResult result;
  run.guard([&] { result.measured = run_measure_stage(setup.measure, run); });
  for (const std::string& r : measurement_remarks(result.measured.data)) result.remarks.push_back(r);
  result.warnings = warnings_of(setup.measure, result.measured);
  result.usable = result.measured.enough_left;
  fit(setup, run, result);
  measure_table(setup, run, result);
  run_macro(setup, run, result);
  PipelineSummary summary = summarise(setup, result, run);
  if (!result.multi_contact_fit.table.entries.empty()) {
    summary.multi_contact = summary_of(result.multi_contact, setup.measured_table->multi_contact.target);
    summary.entries = summaries_of(result.multi_contact_fit.table);
  }
  return {json_of(summary), console_summary(setup, result) + bands_text(result.bands, banded_ends(result.curves))};
}

void check_pipeline(const PipelineSetup& setup, Findings& out) {
  const MeasureTrial trial = check_measurements(setup.measure, out);
  if (setup.measured_table) {
    check_configurations(setup.measured_table->multi_contact, out);
    check_law_prior(setup.measured_table->prior, setup.measure.spec, trial.packing.solid_fraction(), out);
    const auto pool = static_cast<double>(setup.measured_table->multi_contact.pool());
    const auto there = static_cast<double>(setup.measure.packings());
    spend_on_packings(setup.measured_table->multi_contact, trial, std::max(0.0, 1.0 - there / pool), out);
    spend_on_multi_contact(setup.measured_table->multi_contact, trial, 1.0, "measuring with many neighbours", out);
  }
  if (!setup.macro) return;
  add_sizes(out, drawn_sizes(*setup.macro, setup.measure.seed));
  const MacroContent content = content_of(trial, setup.measure.spec, setup.measure.packings(), setup.measure.seed);
  check_macro(*setup.macro, content, nullptr, setup.measure.seed, out);
}

NextSteps next_of(const report::RunData& run) {
  if (run.law_table)
    return {
        "Take the multi-contact law in a scene of your own, with error bars: `softgrain macrosim SCENE.toml "
        "--law " +
            run.directory + "/law_table.toml --bands 20`.",
        "It is measured on a few packings: an hour's worth of them is in `results/law_table`, your own material by "
        "`softgrain run pipelines/law_table.toml`, from a sieve curve by `softgrain run pipelines/graded_sand.toml`."};
  return {"Take the law in a scene of your own: `softgrain macrosim SCENE.toml --law " + run.directory +
              "/law.toml`; values with 95 % intervals: `softgrain law eval " + run.directory +
              "/law.toml --delta 0.1 0.2`.",
          "It is measured with one contact, and too soft where neighbours are all around: laws for packings come from "
          "`softgrain run pipelines/law_table.toml`, more packings from `--set packing.count=32`."};
}

/// As SceneKind::starter.
constexpr const char* kPipelineStarter = R"(title = "Measure, fit, simulate"
seed = 1
[material]
E = "0.5 MPa"
mu = 0.3
[packing]
shell_radius = "16 mm"
polydispersity = 8.0
rmax_over_shell = 0.5
beta = 3.0
placement = "voids"
count = 12
[measure]
relaxation = "damped"
[measure.damped]
increment = 0.01
[measure.soft_solid]
deltas = [0.1, 0.15, 0.2, 0.25, 0.3]
tangential_deltas = [0.2, 0.3]
angles_deg = [-0.05, 0.05]
[measure.soft_soft]
deltas = [0.1, 0.15, 0.2, 0.225, 0.25, 0.275, 0.3, 0.325, 0.35, 0.375, 0.4]
tangential_deltas = [0.35, 0.4]
angles_deg = [-0.05, 0.05]
[calibrate]
replicates = 20
[macro]
bodies = 20
steps = 6
strain = 0.15
)";

}  // namespace

SceneKind pipeline_kind() {
  return scene_kind(
      TypedKind<PipelineSetup>{.name = "pipeline",
                               .command = "run",
                               .read = read_pipeline_setup,
                               .inputs = inputs_of,
                               .run = run_pipeline,
                               .check = check_pipeline,
                               .results = {.next = next_of},
                               .summary = members_of<PipelineSummary>,
                               .keeps = {.measurements = true, .packings = true, .twins = true},
                               .explored_from = {"", "[macro]\n" + explored_stages(),
                                                 std::string("[macro]\n[multi_contact]\n") + kExploredConfiguration},
                               .starter = kPipelineStarter});
}

}  // namespace softgrain
