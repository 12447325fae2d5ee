// Comparisons in the report: every law and both resolved twins on every scene, stress against strain, error against
// cost. Then what runs leave behind.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "pipelines/compare/macro_scores.h"
#include "pipelines/kinds/macro_comparison/scene.h"
#include "pipelines/kinds/macro_comparison/summary.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"
#include "pipelines/report/run_data.h"
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

std::string stress_figure(const ComparedCurves& scene, Stress member, const std::string& what, StrainPart part) {
  const SiPrefix prefix = si_prefix(largest(scene.curves, member));
  const bool sliding = part == StrainPart::shear;
  Plot plot({.id = "macro-" + scene.name + "-" + what + (sliding ? "-sliding" : ""),
             .title = capital(what) + " stress, " + scene.name + (sliding ? ", stages that slide" : ""),
             .x = {.label = part == StrainPart::whole ? "strain [%]" : strain_label(part, MacroTest::stages)},
             .y = {.label = fmt::format("{} stress [{}Pa]", what, prefix.symbol)}});
  add_curves(plot, scene.curves, member, prefix.factor, part);
  const bool periodic = !scene.curves.empty() && scene.curves.front().boundary == Boundary::periodic;
  std::string caption = periodic ? "From the contacts of a periodic cell; one line per sample."
                                 : "From the wall forces; one line per sample.";
  if (member == &MacroCurve::stress_deviator)
    caption +=
        sliding ? " Twice the shear stress: 2σxz." : " Axial less lateral stress: σz − σx, 2σxz where all slides.";
  return plot.empty() ? "" : figure(plot.svg(), caption);
}

/// The same deviator as comparisons take: of stages that slide, where z and x bear alike, twice the shear stress.
std::string deviator_figure(ComparedCurves scene, StrainPart part) {
  for (MacroCurve& c : scene.curves) c.stress_deviator = deviators(c, part);
  return stress_figure(scene, &MacroCurve::stress_deviator, "deviator", part);
}

std::string force_figure(const ComparedCurves& scene) {
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

/// What the samples of a scene are made of, from the summary.
std::string facts_of(const std::vector<ComparedScene>& scenes, const std::string& name) {
  HtmlTable html({"sample", "solid grains", "soft particles", "grains inside", "volume share of soft",
                  "bodies over box", "grains over box", "exponent of all radii", "largest over smallest"});
  for (const ComparedScene& scene : scenes) {
    if (scene.name != name) continue;
    std::size_t k = 0;
    for (const SceneFacts& f : scene.samples) {
      std::vector<std::string> row{std::to_string(k++)};
      for (const double x :
           {static_cast<double>(f.solid), static_cast<double>(f.soft), static_cast<double>(f.inner_grains),
            f.soft_share, f.body_fraction, f.solid_fraction, f.exponent.exponent, f.largest_over_smallest})
        row.push_back(format_number(x, 3));
      html.row(row);
    }
  }
  return html.empty() ? "" : html.html();
}

std::string scene_part(const std::vector<ComparedScene>& compared, const ComparedCurves& scene) {
  const bool shear =
      !scene.curves.empty() && (is_shear(scene.curves.front().test) || scene.curves.front().test == MacroTest::stages);
  std::string body = "<h3>" + escape(scene.name) + "</h3>\n";
  std::vector<std::string> figures;
  for (const StrainPart part : strain_parts(scene.curves.empty() ? MacroTest{} : scene.curves.front().test)) {
    figures.push_back(stress_figure(scene, &MacroCurve::stress_axial, "axial", part));
    figures.push_back(shear ? deviator_figure(scene, part)
                            : stress_figure(scene, &MacroCurve::stress_lateral, "lateral", part));
  }
  figures.push_back(force_figure(scene));
  body += figure_row(figures);
  return body + table_of(score_engines(scene.curves)) + facts_of(compared, scene.name) + law_paragraph(scene.curves);
}

}  // namespace

std::string macro_scenes_section(const RunData& run) {
  std::string body;
  const std::vector<ComparedCurves>& scenes = run.macro_scenes;
  if (!scenes.empty()) body += figure_row({error_cost_figure(run)});
  const auto compared = run.summary_as<ComparedScenes>();
  for (const ComparedCurves& scene : scenes) body += scene_part(compared.scenes, scene);
  if (!body.empty())
    body += paragraph(
        "Stress error: square root of ∫(engine − twin)² over ∫ twin² along the strain, of tests in stages stage by "
        "stage without those that impose it. Coordination, fabric (zz − xx) and forces are those between bodies at the "
        "end, a soft particle being one body. Mean over samples +- standard error.");
  return section("macro-scenes", "Laws and resolved twins",
                 "How far each law is from the resolved twin, scene by scene, and what it costs.", body);
}

}  // namespace softgrain::report

namespace softgrain {

namespace {

using namespace report;

/// The law that comes closest to the shelled twin.
std::string scene_line(const ComparedCurves& scene) {
  const std::vector<EngineScore> scores = score_engines(scene.curves);
  const EngineScore* best = nullptr;
  for (const EngineScore& s : scores) {
    if (headline_of(s.shelled).value.n == 0 || s.twin()) continue;
    if (best == nullptr || headline_of(s.shelled).value.mean < headline_of(best->shelled).value.mean) best = &s;
  }
  if (best == nullptr) return "";
  const ComparedQuantity off = headline_of(best->shelled);
  const MeanError& unloading = best->shelled.unloading;
  return fmt::format(
      "{}: the {} comes closest, {} off by {} % from the shelled twin{}; {} times fewer contact evaluations.",
      scene.name, engine_name(best->engine), off.what,
      format_with_error(100.0 * off.value.mean, 100.0 * off.value.error),
      unloading.n > 0 ? ", unloading modulus " + format_with_error(unloading.mean, unloading.error) + " times its own"
                      : "",
      format_number(best->shelled.speedup_evaluations, 3));
}

std::vector<HeadLine> lines_of(const RunData& run) {
  std::vector<HeadLine> lines;
  for (const ComparedCurves& scene : run.macro_scenes) lines.emplace_back(kResultLabel, scene_line(scene));
  return lines;
}

std::vector<RunValue> values_of(const RunData& run) {
  std::vector<RunValue> out;
  for (const ComparedCurves& scene : run.macro_scenes)
    for (const EngineScore& s : score_engines(scene.curves))
      if (const auto [what, off, ratio] = headline_of(s.shelled); off.n > 0 && !s.twin())
        out.push_back({fmt::format("{} off from the twin ({}, {})", what, scene.name, s.engine), "%", 100.0 * off.mean,
                       100.0 * off.error});
  return out;
}

NextSteps next_of(const RunData&) {
  return {
      "Take the law that comes closest in scenes like these: `softgrain macrosim SCENE.toml --law LAW_TABLE.toml --set "
      "form=NAME`.",
      "What to measure next for it: `softgrain law plan LAW_TABLE.toml --for SCENE.toml`; twins are kept for other "
      "laws by `--twin-cache DIR`."};
}

}  // namespace

KindResults macro_comparison_results() {
  return {.files = {{.names = "comparison\\.json"}, {.names = "(macro|states_macro)_.+\\.h5", .says_so = true}},
          .sections = {{Part::several, macro_scenes_section}},
          .lines = lines_of,
          .values = values_of,
          .next = next_of};
}

}  // namespace softgrain
