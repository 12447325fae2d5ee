#include "pipelines/report/plot_helpers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/core/error.h"
#include "common/core/text.h"
#include "microsim/protocol.h"
#include "pipelines/compare/compare_measurements.h"
#include "pipelines/compare/macro_scores.h"
#include "pipelines/report/html.h"

namespace softgrain::report {
namespace {

void add_scene(const std::string& name, const std::vector<MacroCurve>& curves, std::vector<ErrorCost>& out) {
  for (const EngineScore& s : score_engines(curves)) {
    if (s.twin() == Twin::shelled || !(s.shelled.speedup_evaluations > 0.0)) continue;
    const ComparedQuantity off = headline_of(s.shelled);
    if (off.value.n == 0) continue;
    out.push_back({engine_name(s.engine),
                   fmt::format("{}, {}, {}", name, off.what == "stress" ? "axial stress" : off.what,
                               counted(off.value.n, "sample")),
                   s.engine, 1.0 / s.shelled.speedup_evaluations, off.value.mean, off.value.error});
  }
}

/// Root mean square of ratio - 1 with the error that follows from those of the ratios.
std::pair<double, double> distance_from_one(const std::vector<RatioRow>& rows) {
  double largest = 0.0;
  for (const RatioRow& r : rows) largest = std::max(largest, r.reference.mean);
  double squares = 0.0;
  double weighted = 0.0;
  double n = 0.0;
  for (const RatioRow& r : rows) {
    if (!(r.reference.mean > 0.02 * largest) || !std::isfinite(r.ratio.ratio)) continue;
    const double off = r.ratio.ratio - 1.0;
    squares += off * off;
    weighted += off * off * r.ratio.error * r.ratio.error;
    n += 1.0;
  }
  if (!(n > 0.0 && squares > 0.0)) return {std::nan(""), std::nan("")};
  const double distance = std::sqrt(squares / n);
  return {distance, std::sqrt(weighted) / (n * distance)};
}

void add_relaxation(const RunData& run, PairKind kind, std::vector<ErrorCost>& out) {
  const std::string own = run.relaxation(kind);
  const auto names = relaxations_of(*run.measurements, kind);
  const std::string reference = to_string(Relaxation::published);
  if (own == reference || std::find(names.begin(), names.end(), reference) == names.end()) return;
  try {
    const auto c = compare_relaxations(*run.measurements, reference, own, kind, run.angles(kind));
    const auto [error, deviation] = distance_from_one(c.normal);
    const double cost = c.candidate_normal_cost.contact_evaluations / c.reference_normal_cost.contact_evaluations;
    if (!(error > 0.0) || !(cost > 0.0)) return;
    out.push_back(
        {"relaxation " + own + ", " + to_string(kind),
         fmt::format("normal force against the published relaxation, {}", counted(c.normal.size(), "overlap")), "",
         cost, error, deviation});
  } catch (const InputError&) {  // said in the section of the relaxations
  }
}

Series series_of(const std::string& name, const std::vector<ErrorCost>& points, std::size_t index) {
  Series s{.label = name, .hover = name + ": " + points.front().detail, .x = {}, .y = {}};
  for (const ErrorCost& p : points) {
    s.x.push_back(p.cost);
    s.y.push_back(100.0 * p.error);
    s.y_error.push_back(100.0 * p.deviation);
  }
  if (points.front().engine.empty()) {
    s.style = {.color = index % 2 == 0 ? palette::green : palette::purple, .marker = Marker::triangle};
  } else {
    s.style = engine_style(points.front().engine);
  }
  s.style.width = 0.0;
  s.style.marker_size = 4.2;
  return s;
}

}  // namespace

std::vector<ErrorCost> error_costs(const RunData& run) {
  std::vector<ErrorCost> out;
  std::map<std::string, std::vector<MacroCurve>> tests;
  for (const MacroCurve& c : run.macro) tests[to_string(c.test)].push_back(c);
  for (const auto& [test, curves] : tests) add_scene(test, curves, out);
  for (const ComparedCurves& scene : run.macro_scenes) add_scene(scene.name, scene.curves, out);
  if (run.measurements)
    for (const PairKind kind : kPairKinds) add_relaxation(run, kind, out);
  std::erase_if(out, [](const ErrorCost& p) { return !(p.error > 0.0) || !std::isfinite(p.cost); });
  return out;
}

std::string error_cost_figure(const RunData& run) {
  std::vector<std::pair<std::string, std::vector<ErrorCost>>> groups;  // in order of appearance
  double low = 0.5;
  double high = 2.0;
  double worst = 0.0;
  double best = 100.0;
  for (const ErrorCost& p : error_costs(run)) {
    auto at = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == p.name; });
    if (at == groups.end()) at = groups.insert(groups.end(), {p.name, {}});
    at->second.push_back(p);
    low = std::min(low, 0.5 * p.cost);
    high = std::max(high, 2.0 * p.cost);
    worst = std::max(worst, 100.0 * p.error);
    best = std::min(best, 100.0 * p.error);
  }
  if (groups.empty()) return "";
  Plot plot({.id = "error-cost",
             .title = "Error against cost",
             .x = {.label = "contact evaluations over those of the reference",
                   .scale = Scale::logarithmic,
                   .low = low,
                   .high = high},
             .y = {.label = "difference from the reference [%]",
                   .scale = Scale::logarithmic,
                   .low = 0.4 * best,
                   .high = 2.0 * worst}});
  plot.add({.label = "cost of the reference",
            .hover = "",
            .x = {1.0, 1.0},
            .y = {0.4 * best, 2.0 * worst},
            .style = {.color = palette::grey, .width = 1.2, .dash = "5 4"},
            .sets_range = false});
  std::size_t index = 0;
  for (const auto& [name, points] : groups) plot.add(series_of(name, points, index++));
  return figure(
      plot.svg(),
      "Lower left is better. Reference of the laws: the shelled twin (axial stress, of tests in stages the deviator; "
      "mean over samples, a point per scene); of a relaxation: the published one (normal force, root mean square over "
      "overlaps). Error "
      "bars: standard errors.");
}

}  // namespace softgrain::report
