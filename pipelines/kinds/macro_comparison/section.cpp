// Every law and both resolved twins on every scene: stress against strain, error against cost.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "pipelines/compare/macro_scores.h"
#include "pipelines/report/engine_style.h"
#include "pipelines/report/error_cost.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/sections.h"
#include "pipelines/report/svg_plot.h"

namespace softgrain::report {
namespace {

double largest(const std::vector<MacroCurve>& curves, Stress member) {
  double value = 0.0;
  for (const MacroCurve& c : curves)
    for (const double v : c.*member) value = std::max(value, std::abs(v));
  return value;
}

std::string capital(std::string word) {
  word[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(word[0])));
  return word;
}

std::string stress_figure(const MacroScene& scene, Stress member, const std::string& what) {
  const SiPrefix prefix = si_prefix(largest(scene.curves, member));
  Plot plot({.id = "macro-" + scene.name + "-" + what,
             .title = capital(what) + " stress, " + scene.name,
             .x = {.label = "strain [%]"},
             .y = {.label = fmt::format("{} stress [{}Pa]", what, prefix.symbol)}});
  add_curves(plot, scene.curves, member, prefix.factor);
  return plot.empty() ? "" : figure(plot.svg(), "From the wall forces; one line per sample.");
}

std::string force_figure(const MacroScene& scene) {
  Plot plot({.id = "macro-" + scene.name + "-forces",
             .title = "Contact forces between bodies, " + scene.name,
             .x = {.label = "normal force over its mean", .low = 0.0, .high = 5.0},
             .y = {.label = "share of contacts above", .scale = Scale::logarithmic, .low = 1e-3, .high = 1.0}});
  std::map<std::string, std::vector<double>> forces;  // over the mean of their own sample
  for (const MacroCurve& c : scene.curves) {
    const double mean = mean_and_variation(c.body_forces).first;
    if (!c.usable || !(mean > 0.0)) continue;
    for (const double f : c.body_forces) forces[c.engine].push_back(f / mean);
  }
  for (auto& [engine, values] : forces) {
    std::sort(values.begin(), values.end());
    Series s{.label = engine_name(engine), .hover = "", .x = {}, .y = {}};
    for (std::size_t k = 0; k < values.size(); ++k) {
      s.x.push_back(values[k]);
      s.y.push_back(static_cast<double>(values.size() - k) / static_cast<double>(values.size()));
    }
    s.style = engine_style(engine);
    s.style.marker = Marker::none;
    plot.add(std::move(s));
  }
  return plot.empty() ? "" : figure(plot.svg(), "At the end of the test, all samples together.");
}

/// One column per engine: there are many quantities and few engines.
std::string table_of(const std::vector<EngineScore>& scores) {
  const ScoreTable table = score_table(scores);
  std::vector<std::string> header{""};
  for (const auto& row : table.rows) header.push_back(engine_name(row[0]));
  HtmlTable html(header);
  for (std::size_t k = 1; k < table.header.size(); ++k) {
    std::vector<std::string> cells{table.header[k]};
    for (const auto& row : table.rows) cells.push_back(row[k]);
    const bool any = std::any_of(cells.begin() + 1, cells.end(), [](const std::string& c) { return !c.empty(); });
    if (any) html.row(cells);
  }
  return html.html();
}

std::string cell_of(const nlohmann::json& facts, const char* key) {
  const auto value = find_number(facts, key);
  return value ? format_number(*value, 3) : "–";
}

/// What the samples of a scene are made of, from the summary.
std::string facts_of(const RunData& run, const std::string& name) {
  HtmlTable html({"sample", "solid grains", "soft particles", "grains inside", "volume share of soft",
                  "bodies over box", "grains over box", "exponent of all radii", "largest over smallest"});
  const auto* scenes = find_value(run.summary, "scenes");
  if (scenes == nullptr || !scenes->is_array()) return "";
  for (const auto& scene : *scenes) {
    const auto* samples = find_value(scene, "samples");
    if (find_text(scene, "name") != name || samples == nullptr || !samples->is_array()) continue;
    std::size_t k = 0;
    for (const auto& f : *samples) {
      std::vector<std::string> row{std::to_string(k++)};
      for (const char* key : {"solid", "soft", "inner_grains", "soft_share", "body_fraction", "solid_fraction",
                              "exponent", "polydispersity"})
        row.push_back(cell_of(f, key));
      html.row(row);
    }
  }
  return html.empty() ? "" : html.html();
}

std::string scene_part(const RunData& run, const MacroScene& scene) {
  const bool shear = !scene.curves.empty() && scene.curves.front().test == MacroTest::shear;
  std::string body = "<h3>" + escape(scene.name) + "</h3>\n";
  body += figure_row({stress_figure(scene, &MacroCurve::stress_axial, "axial"),
                      shear ? stress_figure(scene, &MacroCurve::stress_deviator, "deviator")
                            : stress_figure(scene, &MacroCurve::stress_lateral, "lateral"),
                      force_figure(scene)});
  return body + table_of(score_engines(scene.curves)) + facts_of(run, scene.name) + law_paragraph(scene.curves);
}

}  // namespace

std::string macro_scenes_section(const RunData& run) {
  std::string body;
  if (!run.macro_scenes.empty()) body += figure_row({error_cost_figure(run)});
  for (const MacroScene& scene : run.macro_scenes) body += scene_part(run, scene);
  if (!body.empty())
    body += paragraph(
        "Stress error: square root of ∫(engine − twin)² over ∫ twin² along the strain. Coordination, fabric (zz − xx) "
        "and "
        "forces are those between bodies at the end, a soft particle being one body. Mean over samples +- standard "
        "error.");
  return section("macro-scenes", "Laws and resolved twins", body);
}

}  // namespace softgrain::report
