// What each stage cost, and the speed-ups.
#include <fmt/format.h>

#include "pipelines/report/error_cost.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/sections.h"

namespace softgrain::report {
namespace {

void add_row(HtmlTable& table, const std::string& stage, const std::string& what, const Cost& cost) {
  table.row({stage, what, format_count(cost.loop_passes), format_count(cost.contact_evaluations),
             format_seconds(cost.seconds)});
}

void add_measurements(HtmlTable& table, const Measurements& data) {
  for (const PairKind kind : kPairKinds) {
    for (const std::string& relaxation : relaxations_of(data, kind)) {
      Cost normal;
      Cost tangential;
      std::size_t normal_points = 0;
      std::size_t tangential_points = 0;
      for (const PackingRun* run : runs_of(data, kind, relaxation)) {
        normal += run->normal_cost;
        tangential += run->tangential_cost;
        normal_points += run->normal.size();
        tangential_points += run->tangential.size();
      }
      const std::string stage = fmt::format("measurement, {}, {}", to_string(kind), relaxation);
      add_row(table, stage, fmt::format("{} normal points", normal_points), normal);
      if (tangential_points > 0) add_row(table, stage, fmt::format("{} rotations", tangential_points), tangential);
    }
  }
}

void add_macro(HtmlTable& table, const std::vector<MacroCurve>& macro) {
  for (const MacroCurve& c : macro) {
    const std::string inside = c.grains > 0 ? fmt::format(", {} grains inside", format_count(c.grains)) : "";
    add_row(table, fmt::format("macro, {}, sample {}", c.engine, c.sample),
            fmt::format("{} bodies{}", format_count(c.bodies), inside), c.cost);
  }
}

std::string count_text(const nlohmann::json& part, const std::string& key) {
  const auto value = find_number(part, key);
  return value ? format_count(static_cast<std::int64_t>(*value)) : "–";
}

/// Stages that only the summary knows.
void add_summary(HtmlTable& table, const RunData& run) {
  for (const char* stage : {"measurement", "calibration", "macro", "resolved"}) {
    const auto* part = find_value(run.summary, stage);
    const bool shown = (std::string(stage) == "measurement" && run.measurements) ||
                       (std::string(stage) != "calibration" && !run.macro.empty());
    if (part == nullptr || !part->is_object() || shown) continue;
    const auto seconds = find_number(*part, "seconds");
    const bool has_points = find_number(*part, "points").has_value();
    const bool has_bodies = find_number(*part, "bodies").has_value();
    const std::string points = has_points   ? count_text(*part, "points") + " points"
                               : has_bodies ? count_text(*part, "bodies") + " bodies"
                                            : "–";
    table.row({stage, points, count_text(*part, "loop_passes"), count_text(*part, "contact_evaluations"),
               seconds ? format_seconds(*seconds) : "–"});
  }
}

std::string speedups(const nlohmann::json& summary) {
  std::string out;
  if (const auto s = find_number(summary, "comparison.speedup_seconds"))
    out += "speed-up in seconds " + format_number(*s, 3) + "; ";
  if (const auto s = find_number(summary, "comparison.speedup_contact_evaluations"))
    out += "in contact evaluations " + format_number(*s, 3) + "; ";
  if (const auto s = find_number(summary, "comparison.stress_error"))
    out += "at a stress difference of " + format_number(100.0 * *s, 3) + " %; ";
  return out.empty() ? "" : paragraph("Law against resolved twin: " + out.substr(0, out.size() - 2) + ".");
}

}  // namespace

std::string cost_section(const RunData& run) {
  HtmlTable table({"stage", "work", "loop passes", "contact evaluations", "time"}, 2);
  if (run.measurements) add_measurements(table, *run.measurements);
  add_macro(table, run.macro);
  add_summary(table, run);
  const std::string tail = speedups(run.summary);
  // comparisons of laws show it first thing
  const std::string plot = run.macro_scenes.empty() ? error_cost_figure(run) : "";
  const std::string figures = plot.empty() ? "" : figure_row({plot});
  if (table.empty()) return section("cost", "Cost", figures + tail);
  return section("cost", "Cost",
                 figures + table.html() + tail +
                     paragraph("A loop pass evaluates all contacts of a system once; times are wall times of the "
                               "threads that did the work, added up."));
}

}  // namespace softgrain::report
