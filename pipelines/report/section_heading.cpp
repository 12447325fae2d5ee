// What was run and what came out, in a few lines.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/core/error.h"
#include "common/core/statistics.h"
#include "pipelines/compare/compare.h"
#include "pipelines/compare/macro_scores.h"
#include "pipelines/report/engine_style.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/sections.h"

namespace softgrain::report {
namespace {

std::string status_of(const RunData& run) {
  const std::string status = find_text(run.summary, "status");
  return status.empty() ? "no summary" : status;
}

/// Label and text (of data: escaped when written).
using Line = std::pair<std::string, std::string>;

std::string directory_name(const RunData& run) {
  return std::filesystem::weakly_canonical(run.directory).filename().string();
}

/// What the scene calls itself, else command and directory.
std::string title_text(const RunData& run) {
  const std::string title = find_text(run.summary, "title");
  if (!title.empty()) return title;
  const std::string command = find_text(run.summary, "command");
  return (command.empty() ? "softgrain" : "softgrain " + command) + ": " + directory_name(run);
}

std::string title_lines(const RunData& run) {
  const std::string status = status_of(run);
  std::string small = "softgrain " + find_text(run.summary, "command") + ", directory " + directory_name(run);
  for (const char* key : {"version", "commit"}) {
    const std::string value = find_text(run.summary, key);
    if (!value.empty()) small += fmt::format(", {} {}", key, value);
  }
  return "<p class=\"kicker\">" + escape(small) + "</p>\n<h1>" + escape(title_text(run)) +
         " <span class=\"status status-" + (status == "good" ? "good" : "bad") + "\">" + escape(status) +
         "</span></h1>\n";
}

/// Said before anything else when the result must not be used.
std::string verdict(const RunData& run) {
  const std::string status = status_of(run);
  if (status == "good" || status == "no summary") return "";
  std::string reason = "see what to be careful with.";
  if (const auto* list = find_value(run.summary, "remarks");
      list != nullptr && list->is_array() && !list->empty() && (*list)[0].is_string())
    reason = (*list)[0].get<std::string>();
  return "<p class=\"verdict\"><strong>Do not use this result as it is:</strong> " + escape(reason) + "</p>\n";
}

/// Command, seed, threads, time.
std::string run_line(const RunData& run) {
  std::string out;
  const auto add = [&](const std::string& text) { out += (out.empty() ? "" : ", ") + text; };
  if (const std::string seed = find_text(run.summary, "provenance.seed"); !seed.empty()) add("seed " + seed);
  if (const std::string threads = find_text(run.summary, "provenance.threads"); !threads.empty())
    add(threads == "1" ? "one thread" : threads + " threads");
  if (const auto seconds = find_number(run.summary, "seconds")) add(format_seconds(*seconds));
  return out.empty() ? "" : out + ".";
}

std::string material_line(const RunData& run) {
  const SoftParticleSpec& s = run.measurements ? run.measurements->spec : run.card->spec;
  if (!run.measurements && !packing_known(s))
    return fmt::format("Soft particle of an experiment: radius Rs = {} mm, E = {} MPa; what is inside is not known",
                       format_number(1e3 * s.shell_radius), format_number(1e-6 * s.youngs_modulus));
  return fmt::format(
      "Soft particle of radius Rs = {} mm, grains with E = {} MPa, ν = {}, μ = {}; number of radii ~ r^-{} over a "
      "factor {}, largest {} Rs",
      format_number(1e3 * s.shell_radius), format_number(1e-6 * s.youngs_modulus), format_number(s.poisson_ratio),
      format_number(s.friction), format_number(s.exponent), format_number(s.polydispersity),
      format_number(s.rmax_over_shell));
}

std::string measured_line(const Measurements& data) {
  std::size_t points = 0;
  std::vector<double> fraction;
  for (const PackingRun& r : data.runs) points += r.normal.size() + r.tangential.size();
  for (const PackingInfo& p : data.packings) fraction.push_back(p.solid_fraction);
  const MeanError m = mean_error(fraction);
  return fmt::format("{} packings at solid fraction {}, {} relaxed states.", data.packings.size(),
                     format_with_error(m.mean, m.error), format_count(static_cast<std::int64_t>(points)));
}

std::string law_line(const PairLaw& law, const SoftParticleSpec& spec) {
  if (law.status != LawStatus::good || !has_part(law, LawPart::normal))
    return fmt::format("{}: {}{}", to_string(law.kind), to_string(law.status),
                       law.reason.empty() ? "." : ": " + law.reason);
  const double force = spec.youngs_modulus * spec.shell_radius * spec.shell_radius;
  const ThresholdPowerLaw& n = law.normal;
  return fmt::format("{}: Fn = a Δ^b + c above δ; a = {} N, b = {}, c = {} N, δ = {}; fitted for Δ = {} to {}.",
                     to_string(law.kind), format_with_error(n.a.value * force, n.a.standard_error * force),
                     format_with_error(n.b.value, n.b.standard_error), format_number(n.c.value * force, 2),
                     format_with_error(n.delta.value, n.delta.standard_error), format_number(law.delta_min),
                     format_number(law.delta_max));
}

/// Where runs of one engine ended, when there is nothing to compare with.
std::string end_line(const std::vector<MacroCurve>& curves) {
  std::vector<double> stress;
  for (const MacroCurve& c : curves)
    if (!c.stress_axial.empty()) stress.push_back(c.stress_axial.back());
  if (stress.empty()) return "";
  const MeanError mean = mean_error(stress);
  return fmt::format("Axial stress {} Pa at strain {} ({}; {} {}).",
                     stress.size() > 1 ? format_with_error(mean.mean, mean.error) : format_number(mean.mean, 4),
                     format_number(curves.front().strain.back(), 3), to_string(curves.front().test), stress.size(),
                     stress.size() > 1 ? "samples, mean" : "sample");
}

std::string macro_line(const std::vector<MacroCurve>& macro) {
  const auto laws = curves_of(macro, "law");
  const auto twins = curves_of(macro, "shelled");
  if (laws.empty() || twins.empty()) return end_line(laws.empty() ? macro : laws);
  try {
    const Comparison c = compare_curves(laws, twins);
    if (!c.undefined.empty()) return "Law and resolved twin: " + c.undefined.front() + ".";
    return fmt::format(
        "Stress by the law differs from the resolved twin by {} % ({} samples); {} times fewer contact "
        "evaluations, {} times faster.",
        format_with_error(100 * c.axial_difference.mean, 100 * c.axial_difference.error), c.samples.size(),
        format_number(c.speedup_contact_evaluations, 3), format_number(c.speedup_seconds, 3));
  } catch (const BadInput& error) {
    return error.what();
  }
}

std::string table_line(const LawTableEntry& entry) {
  const CrowdLaw* best = entry.find(entry.best);
  if (best == nullptr) return "";
  std::string held_out;
  if (std::isfinite(best->error_held_out))
    held_out = fmt::format(" and by {} % on what was held out", format_number(100.0 * best->error_held_out, 2));
  return fmt::format("Solid fraction {}: the {} law is best, off by {} % where it was fitted{}; h/Rs up to {}.",
                     format_number(entry.solid_fraction, 3), to_string(entry.best),
                     format_number(100.0 * best->error_fitted, 2), held_out, format_number(entry.overlap_max, 2));
}

/// The law that comes closest to the shelled twin.
std::string scene_line(const MacroScene& scene) {
  const std::vector<EngineScore> scores = score_engines(scene.curves);
  const EngineScore* best = nullptr;
  for (const EngineScore& s : scores) {
    if (s.shelled.axial.n == 0 || s.twin()) continue;
    if (best == nullptr || s.shelled.axial.mean < best->shelled.axial.mean) best = &s;
  }
  if (best == nullptr) return "";
  return fmt::format(
      "{}: the {} comes closest, stress off by {} % from the shelled twin; {} times fewer contact evaluations.",
      scene.name, engine_name(best->engine),
      format_with_error(100.0 * best->shelled.axial.mean, 100.0 * best->shelled.axial.error),
      format_number(best->shelled.speedup_evaluations, 3));
}

std::vector<Line> grain_box_lines(const RunData& run) {
  if (run.grain_boxes.size() > 3) return {{"Packs", fmt::format("{} packs of grains.", run.grain_boxes.size())}};
  std::vector<Line> lines;
  for (const GrainBoxResult& r : run.grain_boxes) {
    const auto points = r.points_of(BoxPhase::loading);
    if (points.empty()) continue;
    lines.emplace_back(
        "Pack " + r.spec.name,
        fmt::format("{} grains, {} loading to a confining stress of {} MPa; {} states.", format_count(r.spec.grains),
                    r.spec.loading.test, format_number(points.back()->pressure * 1e-6, 4), r.state.points.size()));
  }
  return lines;
}

/// What came out, a few lines whatever the kind of run.
std::vector<Line> result_lines(const RunData& run) {
  std::vector<Line> lines;
  if (run.measurements) lines.emplace_back("Measured", measured_line(*run.measurements));
  if (run.card)
    for (const PairLaw& law : run.card->pairs) lines.emplace_back("Law", law_line(law, run.card->spec));
  if (run.law_table)
    for (const LawTableEntry& entry : run.law_table->entries) lines.emplace_back("Law", table_line(entry));
  lines.emplace_back("Levels", find_text(run.summary, "fixed_point.text"));
  if (!run.macro.empty()) lines.emplace_back("Macro", macro_line(run.macro));
  for (const MacroScene& scene : run.macro_scenes) lines.emplace_back("Macro", scene_line(scene));
  if (const auto* particles = find_value(run.summary, "particles"); particles != nullptr && particles->is_array())
    lines.emplace_back("Scene", fmt::format("{} explicit particles.", particles->size()));
  for (Line& line : grain_box_lines(run)) lines.push_back(std::move(line));
  if (run.powder) lines.emplace_back("Powder", fmt::format("{} packs of disks.", run.powder->samples.size()));
  std::erase_if(lines, [](const Line& line) { return line.second.empty(); });
  return lines;
}

/// Lines with the same label follow each other under one.
std::string list_of(const std::vector<Line>& lines) {
  std::string out;
  std::string open;
  for (const auto& [label, text] : lines) {
    out += label == open ? "<br>" : (out.empty() ? "" : "</dd>\n") + ("<dt>" + escape(label) + "</dt><dd>");
    out += escape(text);
    open = label;
  }
  return out.empty() ? "" : "<dl class=\"lead\">\n" + out + "</dd>\n</dl>\n";
}

}  // namespace

std::string heading_section(const RunData& run) {
  std::string what = run_line(run);
  if (run.measurements || run.card) {
    const std::string material = material_line(run);
    what = material + (what.empty() ? "." : "; " + what);
  }
  std::vector<Line> lines = result_lines(run);
  if (!what.empty()) lines.insert(lines.begin(), {"Run", what});
  return title_lines(run) + verdict(run) + list_of(lines);
}

}  // namespace softgrain::report
