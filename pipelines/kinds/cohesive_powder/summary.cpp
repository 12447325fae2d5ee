// What was measured on powders, into HDF5 and the summary, and their consolidation under several pressures.
#include "pipelines/kinds/cohesive_powder/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "common/core/statistics.h"
#include "common/data/columns.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/svg_plot.h"

namespace softgrain {

namespace {

using nlohmann::json;

constexpr std::array kHistograms{std::pair{"normal", &PowderForces::normal},
                                 std::pair{"normal_over_mean", &PowderForces::normal_over_mean},
                                 std::pair{"ratio", &PowderForces::ratio}, std::pair{"angle", &PowderForces::angle}};

void write_pairs(const h5::Group& group, const std::vector<PowderInteraction>& pairs) {
  constexpr std::size_t kColumns = 10;
  std::vector<double> rows;
  for (const auto& p : pairs)
    rows.insert(rows.end(),
                {static_cast<double>(p.i), static_cast<double>(p.j), p.normal[0], p.normal[1], p.branch[0], p.branch[1],
                 p.normal_force, p.tangential_force, p.rolling_moment, static_cast<double>(p.kind)});
  group.write("pairs", rows, {pairs.size(), kColumns});
  group.attribute_of(
      "pairs", "columns",
      "slots i, j; normal to i x, y; branch x_i - x_j x, y [a]; N, T [F0; without cohesion P a]; rolling "
      "moment on i; kind: 0 compressive, 1 tensile, 2 distant, 3 unstressed");
}

using nlohmann::json;
using Values = std::map<std::string, std::vector<double>>;

void collect(const json& object, const std::string& path, Values& values) {
  for (const auto& [key, value] : object.items()) {
    const std::string name = path.empty() ? key : path + "." + key;
    if (value.is_object()) collect(value, name, values);
    if (value.is_number()) values[name].push_back(value.get<double>());
    if (value.is_null()) values[name];  // named, though undefined
  }
}

json statistics_of(const std::vector<double>& values) {
  const MeanError m = mean_error(values);
  json out{{"mean", nullptr}, {"deviation", nullptr}, {"samples", m.n}};
  if (m.n > 0) out["mean"] = m.mean;
  if (m.n > 1) out["deviation"] = m.deviation;
  return out;
}

}  // namespace

json histograms_json(const std::vector<const PowderForces*>& samples) {
  PowderForces sum;
  json out = json::object();
  for (const auto& [name, member] : kHistograms) {
    Histogram& h = sum.*member;
    for (const PowderForces* sample : samples) add_counts(h, sample->*member);
    out[name] = {{"low", h.low}, {"high", h.high}, {"below", h.below}, {"above", h.above}, {"counts", h.counts}};
  }
  return out;
}

void write_analysis(const h5::Group& group, const PowderAnalysis& analysis) {
  write_pairs(group, analysis.pairs);
  const h5::Group histograms = group.create("histograms");
  for (const auto& [name, member] : kHistograms) write_histogram(histograms.create(name), analysis.forces.*member);
  group.attribute("scalars", json_of(analysis).dump());
}

json sample_statistics(const std::vector<json>& samples) {
  Values values;
  for (const json& sample : samples) collect(sample, "", values);
  json out = json::object();
  for (const auto& [name, list] : values) out[name] = statistics_of(list);
  return out;
}

namespace {

/// Stages up to the largest pressure.
std::size_t rising(const PowderStages& stages) {
  const auto top = std::max_element(stages.begin(), stages.end(),
                                    [](const PowderStage& a, const PowderStage& b) { return a.pressure < b.pressure; });
  return top == stages.end() ? 0 : static_cast<std::size_t>(top - stages.begin()) + 1;
}

/// Samples that went as far as any.
std::vector<const PowderStages*> whole(const std::vector<PowderStages>& samples) {
  std::size_t most = 0;
  for (const PowderStages& s : samples) most = std::max(most, s.size());
  std::vector<const PowderStages*> out;
  for (const PowderStages& s : samples)
    if (s.size() == most && most > 1) out.push_back(&s);
  return out;
}

}  // namespace

std::optional<ConsolidationFit> consolidation_of(const std::vector<PowderStages>& samples) {
  const auto chosen = whole(samples);
  if (chosen.empty() || rising(*chosen.front()) < 2) return std::nullopt;
  ConsolidationCurves curves;
  const std::size_t n = rising(*chosen.front());
  for (std::size_t k = 0; k < n; ++k) curves.pressure.push_back((*chosen.front())[k].pressure);
  for (const PowderStages* s : chosen) {
    std::vector<double> fraction;
    for (std::size_t k = 0; k < n; ++k) fraction.push_back((*s)[k].fraction);
    curves.fraction.push_back(std::move(fraction));
  }
  return fit_consolidation(curves);
}

std::string consolidation_text(const ConsolidationFit& fit) {
  using report::format_number;
  using report::format_with_error;
  if (!fit.usable) return "consolidation not determined: " + fit.reason;
  std::string text =
      fmt::format("1/Phi falls by lambda = {} per unit of ln P* for P* from {} to {}; regime I ends at P* = {}",
                  format_with_error(fit.slope.value, fit.slope.error), format_number(fit.low, 3),
                  format_number(fit.high, 3), format_number(fit.begin, 2));
  if (fit.exponent && fit.densest)
    text += fmt::format("; beyond, Phi_max - Phi ~ P*^-alpha with alpha = {}, Phi_max = {}",
                        format_with_error(fit.exponent->value, fit.exponent->error),
                        format_with_error(fit.densest->value, fit.densest->error));
  if (!fit.reason.empty()) text += "; not determined: " + fit.reason;
  return text;
}

namespace report {

namespace {

using StageValue = double (*)(const PowderStage&);

Series stage_series(const PowderStages& stages, std::size_t first, std::size_t last, StageValue value,
                    const std::string& label, const SeriesStyle& style) {
  Series s{.label = label, .hover = label, .x = {}, .y = {}};
  for (std::size_t k = first; k < last; ++k) {
    s.x.push_back(stages[k].pressure);
    s.y.push_back(value(stages[k]));
  }
  s.style = style;
  return s;
}

/// Way up with filled marks, way down dashed.
void add_samples(Plot& plot, const std::vector<PowderStages>& samples, StageValue value, const std::string& color,
                 const std::string& name) {
  bool first = true;
  for (const PowderStages& s : samples) {
    const std::size_t top = rising(s);
    if (top == 0) continue;
    plot.add(stage_series(s, 0, top, value, first ? name : "",
                          {.color = color, .width = 1.3, .marker = Marker::circle, .marker_size = 2.6}));
    if (top < s.size())
      plot.add(stage_series(s, top - 1, s.size(), value, first ? name + ", unloading" : "",
                            {.color = color, .width = 1.1, .dash = "5 3"}));
    first = false;
  }
}

AxisOptions pressure_axis() { return {.label = "P a/F0", .scale = Scale::logarithmic}; }

std::string density_figure(const std::vector<PowderStages>& samples, const std::optional<ConsolidationFit>& fit) {
  Plot plot({.id = "powder-consolidation", .title = "Consolidation", .x = pressure_axis(), .y = {.label = "1/Phi"}});
  add_samples(
      plot, samples, [](const PowderStage& s) { return 1.0 / s.fraction; }, palette::blue, "samples");
  if (fit && fit->usable) {
    double offset = 0.0;
    const auto chosen = whole(samples);
    for (const PowderStages* s : chosen) offset += 1.0 / s->front().fraction / static_cast<double>(chosen.size());
    Series line{.label = fmt::format("lambda = {}", format_with_error(fit->slope.value, fit->slope.error)),
                .hover = "",
                .x = {fit->low, fit->high},
                .y = {}};
    for (const double p : line.x) line.y.push_back(offset - fit->slope.value * std::log(p / fit->begin));
    line.style = {.color = palette::vermillion, .width = 2.2};
    plot.add(std::move(line));
  }
  return figure(plot.svg(), fit ? consolidation_text(*fit) + "." : "At rest under every pressure.");
}

}  // namespace

std::string consolidation_figures(const std::vector<PowderStages>& samples) {
  if (whole(samples).empty()) return "";
  Plot contacts({.id = "powder-stages-z", .title = "Coordination number", .x = pressure_axis(), .y = {.label = "z"}});
  add_samples(
      contacts, samples, [](const PowderStage& s) { return s.coordination; }, palette::blue, "samples");
  Plot moduli({.id = "powder-stages-moduli",
               .title = "Elastic moduli",
               .x = pressure_axis(),
               .y = {.label = "B, G [F0/a]", .scale = Scale::logarithmic}});
  add_samples(
      moduli, samples, [](const PowderStage& s) { return s.bulk; }, palette::blue, "B");
  add_samples(
      moduli, samples, [](const PowderStage& s) { return s.shear; }, palette::vermillion, "G");
  return figure_row({density_figure(samples, consolidation_of(samples)),
                     figure(contacts.svg(), "Interactions per disk, distant pairs included."),
                     figure(moduli.svg(), "Of the springs of all contacts, prestress left out.")});
}

}  // namespace report

}  // namespace softgrain
