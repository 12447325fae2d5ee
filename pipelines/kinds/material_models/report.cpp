// Models in the report: stress of truth and models, errors, error against cost. Then what runs leave behind.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "common/core/text.h"
#include "pipelines/kinds/material_models/scene.h"
#include "pipelines/kinds/material_models/summary.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/report/svg_plot.h"

namespace softgrain {

namespace report {
namespace {

constexpr const char* kNothing = "–";

/// "12.3 %" of a share, "12.3 ± 0.4 %" with its error; "–" where it is not finite.
std::string percent(double share, double error = kNaN) {
  if (!std::isfinite(share)) return kNothing;
  const ErrorForm form{.value = {1, true}, .error = {1, true}, .between = " ± "};
  return with_error(100.0 * share, if_finite(100.0 * error), form) + " %";
}

/// Half width of the band, and the share of the points that it holds.
std::string band_text(const ModelScore& s) {
  return std::isfinite(s.band) ? "± " + percent(s.band) + ", " + percent(s.inside) : kNothing;
}

struct ScoreColumn {
  const char* title;
  std::string (*text)(const ModelScore&);
};

constexpr std::array<ScoreColumn, 14> kScoreColumns{
    {{"bodies", [](const ModelScore& s) { return format_count(s.bodies); }},
     {"axial", [](const ModelScore& s) { return percent(s.axial, s.axial_error); }},
     {"lateral", [](const ModelScore& s) { return percent(s.lateral, s.lateral_error); }},
     {"at 2 %", [](const ModelScore& s) { return percent(s.axial_at_2); }},
     {"at the end", [](const ModelScore& s) { return percent(s.axial_at_end); }},
     {"q/p at 2 %", [](const ModelScore& s) { return percent(s.ratio_at_2); }},
     {"q/p at 6 %", [](const ModelScore& s) { return percent(s.ratio_at_6); }},
     {"volume, triaxial", [](const ModelScore& s) { return std::isfinite(s.volume) ? volume_text(s) : kNothing; }},
     {"unloading modulus", [](const ModelScore& s) { return percent(s.unloading); }},
     {"truth ±", [](const ModelScore& s) { return percent(s.truth_error); }},
     {"band, inside", band_text},
     {"fewer evaluations", [](const ModelScore& s) { return format_number(s.evaluations, 3); }},
     {"faster", [](const ModelScore& s) { return format_number(s.seconds, 3); }},
     {"with preparation", [](const ModelScore& s) { return format_number(s.seconds_all, 3); }}}};

/// Columns that say something of any model.
std::string score_table(const std::vector<ModelScore>& scores, bool blind) {
  std::vector<ScoreColumn> columns;
  const auto says = [&](const ScoreColumn& c) {
    return std::ranges::any_of(scores, [&](const ModelScore& s) { return s.blind == blind && c.text(s) != kNothing; });
  };
  std::ranges::copy_if(kScoreColumns, std::back_inserter(columns), says);
  std::vector<std::string> header{"material", "model"};
  for (const ScoreColumn& c : columns) header.emplace_back(c.title);
  HtmlTable table(header);
  HtmlTable remarks({"material", "model", "remark"}, 3);
  for (const ModelScore& s : scores) {
    if (s.blind != blind) continue;
    std::vector<std::string> row{s.variant, s.model};
    for (const ScoreColumn& c : columns) row.push_back(c.text(s));
    table.row(std::move(row));
    if (!s.remark.empty()) remarks.row({s.variant, s.model, s.remark});
  }
  return (table.empty() ? "" : table.html()) + (remarks.empty() ? "" : remarks.html());
}

std::string cost_figure(const std::vector<ModelScore>& scores) {
  Plot plot({.id = "models-cost",
             .title = "Error against cost",
             .x = {.label = "evaluations of the truth over those of the model", .scale = Scale::logarithmic},
             .y = {.label = "error of the axial stress [%]", .scale = Scale::logarithmic}});
  std::vector<std::string> models;
  for (const ModelScore& s : scores)
    if (std::ranges::find(models, s.model) == models.end()) models.push_back(s.model);
  bool any = false;
  for (std::size_t k = 0; k < models.size(); ++k) {
    Series points{.label = models[k], .hover = "", .x = {}, .y = {}};
    for (const ModelScore& s : scores)
      if (s.model == models[k] && std::isfinite(s.axial) && s.axial > 0.0 && std::isfinite(s.evaluations)) {
        points.x.push_back(s.evaluations);
        points.y.push_back(100.0 * s.axial);
      }
    points.style = {.color = palette::cycle(k), .width = 0.0, .marker = Marker::circle};
    if (points.x.empty()) continue;
    any = true;
    plot.add(std::move(points));
  }
  return any ? figure(plot.svg(),
                      "Each point is one material under one loading; contacts, or faces of cells, of the tests alone. "
                      "A face costs more "
                      "than a contact: see the times of the table.")
             : "";
}

std::vector<double> in_percent(std::vector<double> values) {
  for (double& v : values) v *= 100.0;
  return values;
}

/// Models that are far off leave the drawing.
double shown_up_to(const std::vector<MacroCurve>& truth) {
  double largest = 0.0;
  for (const MacroCurve& c : truth)
    for (const double stress : c.stress_axial) largest = std::max(largest, stress);
  return 2.0 * largest;
}

/// First samples of the truth and of every model.
std::string stress_figure_of(const RunData& run, const MaterialVariantSummary& v) {
  const auto* truth = run.file(v.file, load_macro);
  const auto* models = run.file("models_" + v.name + ".h5", load_macro);
  if (truth == nullptr || models == nullptr || truth->empty()) return "";
  Plot plot({.id = "models-" + v.name,
             .title = v.name,
             .x = {.label = "axial strain [%]"},
             .y = {.label = "axial stress [Pa]", .low = 0.0, .high = shown_up_to(*truth)}});
  for (const MacroCurve& c : *truth) {
    Series s{
        .label = &c == truth->data() ? "truth" : "", .hover = "", .x = in_percent(c.strain_z), .y = c.stress_axial};
    s.style = {.color = palette::black, .width = 1.8};
    plot.add(std::move(s));
  }
  std::vector<std::string> names;
  for (const MacroCurve& c : *models) {
    if (c.sample != 0) continue;
    names.push_back(c.engine);
    Series s{.label = c.engine, .hover = "", .x = in_percent(c.strain_z), .y = c.stress_axial};
    s.style = {.color = palette::cycle(names.size() - 1), .width = 1.2};
    plot.add(std::move(s));
  }
  return figure(plot.svg(), "All samples of the truth, the first one of every model.");
}

}  // namespace

std::string material_models_section(const RunData& run) {
  const auto summary = run.summary_as<MaterialModelsSummary>();
  if (summary.scores.empty()) return "";
  std::string text =
      "Errors over the curve: square root of the sum of (model − truth)² over that of truth², of all points from 1 % "
      "strain on, of means over samples. Others: model over truth less 1.";
  if (std::ranges::any_of(summary.scores, [](const ModelScore& s) { return std::isfinite(s.band); }))
    text +=
        " Band: half width of the 95 % band that the errors of the card give the axial stress; inside: the share of "
        "all points that it holds.";
  std::string body = paragraph(text);
  body += score_table(summary.scores, false);
  const std::string blind = score_table(summary.scores, true);
  if (!blind.empty()) body += "<h3>Blind: other mixtures and preparations than the law was measured on</h3>\n" + blind;
  body += figure_row({cost_figure(summary.scores)});
  std::vector<std::string> figures;
  for (const MaterialVariantSummary& v : summary.material.variants) figures.push_back(stress_figure_of(run, v));
  body += figure_row(figures);
  return section("material-models", "Models compared with the resolved material",
                 "Stress of each model against the material with every grain resolved: error against cost.", body);
}

}  // namespace report

namespace {

std::vector<RunValue> values_of(const report::RunData& run) {
  std::vector<RunValue> out;
  for (const ModelScore& s : run.summary_as<MaterialModelsSummary>().scores)
    if (std::isfinite(s.axial) && s.samples > 0)
      out.push_back({fmt::format("axial stress off from the truth ({}, {})", s.variant, s.model), "%", 100.0 * s.axial,
                     100.0 * s.axial_error});
  return out;
}

NextSteps next_of(const report::RunData&) {
  return {
      "Take the model whose error is smallest at the cost you can afford: of cells `softgrain macrosim SCENE.toml "
      "--law cell_law.toml`.",
      "Whether its error is beyond scatter: more samples (`--set samples=6`), or other packings of the same material "
      "(`--seeds 1..4`)."};
}

}  // namespace

KindResults material_models_results() {
  return {.files = {{.names = "models_.+\\.h5"}, {.names = "models\\.csv"}},
          .sections = {{Part::tests, report::material_models_section}},
          .values = values_of,
          .next = next_of};
}

}  // namespace softgrain
