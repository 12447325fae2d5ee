// Two relaxations of the same packings side by side: means, their ratio, and what a point costs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "pipelines/compare/compare_measurements.h"
#include "pipelines/kinds/soft_particle/results.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/run_data.h"

namespace softgrain::report {
namespace {

/// Means of one side.
Series side_series(const std::vector<RatioRow>& rows, bool candidate, const std::string& name) {
  Series s{.label = name + ", mean ± standard error", .hover = name, .x = {}, .y = {}};
  for (const RatioRow& row : rows) {
    const MeanError& m = candidate ? row.candidate : row.reference;
    s.x.push_back(row.delta);
    s.y.push_back(m.mean);
    s.y_error.push_back(m.error);
  }
  s.style = candidate
                ? SeriesStyle{.color = palette::blue, .width = 1.4, .marker = Marker::circle}
                : SeriesStyle{.color = palette::vermillion, .width = 1.4, .dash = "6 3", .marker = Marker::square};
  return s;
}

Series ratio_series(const std::vector<RatioRow>& rows, const std::string& label, const char* color, Marker marker) {
  Series s{.label = label, .hover = "", .x = {}, .y = {}};
  for (const RatioRow& row : rows) {
    s.x.push_back(row.delta);
    s.y.push_back(row.ratio.ratio);
    s.y_error.push_back(row.ratio.error);
  }
  s.style = {.color = color, .width = 1.2, .marker = marker};
  return s;
}

std::string means_figure(const RelaxationComparison& c) {
  Plot plot({.id = "relaxations-" + to_string(c.kind) + "-means",
             .title = "Fn(Δ) of both relaxations, " + to_string(c.kind),
             .x = {.label = "normal overlap Δ = hn/Rs", .low = 0.0},
             .y = {.label = "normal force Fn [N]", .scale = Scale::logarithmic}});
  plot.add(side_series(c.normal, false, c.reference));
  plot.add(side_series(c.normal, true, c.candidate));
  return figure(plot.svg(), "Packings that both relaxations measured.");
}

std::string ratio_figure(const RelaxationComparison& c) {
  Plot plot({.id = "relaxations-" + to_string(c.kind) + "-ratio",
             .title = "Ratio " + c.candidate + " / " + c.reference + ", " + to_string(c.kind),
             .x = {.label = "normal overlap Δ = hn/Rs", .low = 0.0},
             .y = {.label = "ratio of means"}});
  const double last = c.normal.empty() ? 1.0 : 1.1 * c.normal.back().delta;
  plot.add({.label = "",
            .hover = "equal",
            .x = {0.0, last},
            .y = {1.0, 1.0},
            .style = {.color = palette::black, .width = 1.0, .dash = "3 3"}});
  plot.add(ratio_series(c.normal, "normal force", palette::blue, Marker::circle));
  if (!c.stiffness_initial.empty())
    plot.add(ratio_series(c.stiffness_initial, "kt, initial slope", palette::vermillion, Marker::square));
  if (!c.stiffness_secant.empty())
    plot.add(ratio_series(c.stiffness_secant, "kt, secant", palette::green, Marker::triangle));
  return figure(plot.svg(), "Error bars: jackknife over packings.");
}

std::string mean_text(const MeanError& m) { return format_with_error(m.mean, m.error); }

void add_rows(HtmlTable& table, const std::string& quantity, const std::vector<RatioRow>& rows) {
  for (const RatioRow& row : rows) {
    table.row({quantity, format_fixed(row.delta, 3), format_count(static_cast<std::int64_t>(row.reference.n)),
               mean_text(row.reference), mean_text(row.candidate),
               format_with_error(row.ratio.ratio, row.ratio.error)});
  }
}

std::string ratio_table(const RelaxationComparison& c) {
  HtmlTable table({"quantity", "Δ", "packings", c.reference, c.candidate, "ratio"});
  add_rows(table, "Fn [N]", c.normal);
  add_rows(table, "kt initial [N/m]", c.stiffness_initial);
  add_rows(table, "kt secant [N/m]", c.stiffness_secant);
  return table.html();
}

void add_cost_row(HtmlTable& table, const std::string& points, const std::string& name, const PointCost& cost,
                  const PointCost& reference) {
  if (cost.points == 0) return;
  table.row({points, name, format_count(cost.points), format_count(std::llround(cost.loop_passes)),
             format_count(std::llround(cost.contact_evaluations)), format_number(cost.seconds, 3),
             format_number(reference.seconds / cost.seconds, 3)});
}

std::string cost_table(const RelaxationComparison& c) {
  HtmlTable table({"points", "relaxation", "number", "loop passes per point", "contact evaluations per point",
                   "seconds per point", "speed-up"},
                  2);
  add_cost_row(table, "normal", c.reference, c.reference_normal_cost, c.reference_normal_cost);
  add_cost_row(table, "normal", c.candidate, c.candidate_normal_cost, c.reference_normal_cost);
  add_cost_row(table, "tangential", c.reference, c.reference_tangential_cost, c.reference_tangential_cost);
  add_cost_row(table, "tangential", c.candidate, c.candidate_tangential_cost, c.reference_tangential_cost);
  return table.html();
}

/// The reference is the published relaxation when it is there; the candidate is the first other one.
std::string relaxations_of(const RunData& run, PairKind kind) {
  const auto names = relaxations_of(*run.measurements, kind);
  if (names.size() < 2) return "";
  const bool published = std::find(names.begin(), names.end(), "published") != names.end();
  const std::string reference = published ? "published" : names[0];
  const std::string candidate = names[0] == reference ? names[1] : names[0];
  try {
    const auto c = compare_relaxations(*run.measurements, reference, candidate, kind, run.angles(kind));
    return "<h3>" + escape(describe(kind)) + "</h3>\n" + figure_row({means_figure(c), ratio_figure(c)}) +
           ratio_table(c) + cost_table(c);
  } catch (const InputError& error) {
    return paragraph(error.what());
  }
}

}  // namespace

std::string relaxations_section(const RunData& run) {
  if (!run.measurements) return "";
  std::string body;
  for (const PairKind kind : kPairKinds) body += relaxations_of(run, kind);
  return section("relaxations", "Relaxation protocols compared",
                 "The same packings relaxed by two protocols, and how far their forces differ.", body);
}

}  // namespace softgrain::report
