// What each stage cost, and the speed-ups.
#include <fmt/format.h>

#include <cmath>
#include <set>

#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/sections.h"
#include "pipelines/results/summary.h"

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
  std::set<std::string> prepared;  // engines share their starting states
  for (const MacroCurve& c : macro) {
    if (c.preparation.loop_passes > 0 && prepared.insert(c.start.bodies).second)
      add_row(table, fmt::format("preparation, sample {}", c.sample), fmt::format("{} bodies", format_count(c.bodies)),
              c.preparation);
    const std::string inside = c.grains > 0 ? fmt::format(", {} grains inside", format_count(c.grains)) : "";
    add_row(table, fmt::format("macro, {}, sample {}", c.engine, c.sample),
            fmt::format("{} bodies{}", format_count(c.bodies), inside), c.cost);
  }
}

/// Stages whose data lie elsewhere, from the summary.
struct StageCosts {
  std::optional<MeasurementSummary> measurement;
  std::optional<EngineSummary> macro;
  std::optional<EngineSummary> resolved;
  std::optional<ComparisonSummary> comparison;
};

void fields(auto&& visit, Of<StageCosts> auto& s) {
  visit("measurement", s.measurement);
  visit("macro", s.macro);
  visit("resolved", s.resolved);
  visit("comparison", s.comparison);
}

void add_summary(HtmlTable& table, const RunData& run, const StageCosts& stages) {
  if (stages.measurement && !run.measurements)
    add_row(table, "measurement", format_count(stages.measurement->points) + " points", stages.measurement->cost);
  if (!run.macro.empty()) return;
  for (const auto& [name, engine] : {std::pair("macro", &stages.macro), std::pair("resolved", &stages.resolved)})
    if (*engine) add_row(table, name, format_count((*engine)->bodies) + " bodies", (*engine)->cost);
}

std::string speedups(const std::optional<ComparisonSummary>& comparison) {
  if (!comparison) return "";
  std::string out;
  if (const double s = comparison->speedup_seconds; !std::isnan(s))
    out += "speed-up in seconds " + format_number(s, 3) + "; ";
  if (const double s = comparison->speedup_contact_evaluations; !std::isnan(s))
    out += "in contact evaluations " + format_number(s, 3) + "; ";
  if (comparison->deviator_error)  // of tests in stages, whose stresses are imposed in part
    out += "at a difference of the deviator of " + format_number(100.0 * *comparison->deviator_error, 3) + " %; ";
  else if (const double s = comparison->stress_error; !std::isnan(s))
    out += "at a stress difference of " + format_number(100.0 * s, 3) + " %; ";
  return out.empty() ? "" : paragraph("Law against resolved twin: " + out.substr(0, out.size() - 2) + ".");
}

}  // namespace

std::string cost_section(const RunData& run) {
  HtmlTable table({"stage", "work", "loop passes", "contact evaluations", "time"}, 2);
  if (run.measurements) add_measurements(table, *run.measurements);
  add_macro(table, run.macro);
  const auto stages = run.summary_as<StageCosts>();
  add_summary(table, run, stages);
  const std::string tail = speedups(stages.comparison);
  // comparisons of laws show it first thing
  const std::string plot = run.macro_scenes.empty() ? error_cost_figure(run) : "";
  const std::string figures = plot.empty() ? "" : figure_row({plot});
  std::string body = figures;
  if (!table.empty()) body += table.html();
  body += tail;
  if (!table.empty())
    body += paragraph(
        "A loop pass evaluates all contacts of a system once; times are wall times of the threads that did the work, "
        "added up.");
  return section("cost", "Cost", "Where the time of the run went.", body);
}

}  // namespace softgrain::report
