// The cell law in the report: its numbers, excess pores over the mixture, stress ratios of the fines against the law.
// Then what runs leave behind.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/core/text.h"
#include "common/data/cell_card.h"
#include "common/data/law_words.h"
#include "pipelines/kinds/law_table/scene.h"
#include "pipelines/kinds/material_law/scene.h"
#include "pipelines/kinds/material_law/summary.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/report/svg_plot.h"

namespace softgrain::report {

namespace {

std::string interval_of(const Estimate& e) { return ends_text(e.low, e.high, {format_number, 3, " to "}); }

std::string of_pair(const CellLawSummary& law, const std::string& name) {
  for (const LawNumber& n : law.of_pair)
    if (n.name == name) return format_number(n.estimate.value);
  return "–";
}

std::string number_table(const CellLawSummary& law) {
  const bool recipe = !law.of_pair.empty();
  std::vector<std::string> header{"number", "meaning", recipe ? "value on the card" : "value", "95 % interval"};
  if (recipe) header.emplace_back("of the two coarsest levels alone");
  HtmlTable table(header, 2);
  for (const LawNumber& n : law.numbers) {
    std::vector<std::string> row{n.name, meaning_of_cell_number(n.name), format_number(n.estimate.value),
                                 interval_of(n.estimate)};
    if (recipe) row.emplace_back(of_pair(law, n.name));
    table.row(row);
  }
  if (!recipe) return table.html();
  return table.html() +
         paragraph(
             "The card holds for grains of the coarsest level among everything finer: e_J is that of all finer "
             "levels together, and w_inf goes with it. The figures show what was measured on the two coarsest "
             "levels alone.");
}

double half_of(const Estimate& e) { return std::isfinite(e.high) ? 0.5 * (e.high - e.low) : 0.0; }

std::string pores_figure(const CellLawSummary& law) {
  Plot plot({.id = "cell-law-pores", .title = "Excess pores", .x = {.label = "V_f/V_c"}, .y = {.label = "W/V_c"}});
  if (law.band) {
    Series fit{.label = "fitted form", .hover = "", .x = law.band->ratio, .y = law.band->value};
    fit.style = {.color = palette::blue, .width = 1.6};
    bool known = true;
    for (const double x : law.band->high) known = known && std::isfinite(x);
    if (known) {
      fit.band_low = law.band->low;
      fit.band_high = law.band->high;
    }
    plot.add(std::move(fit));
  }
  Series points{.label = "measured", .hover = "", .x = {}, .y = {}};
  for (const LawNumber& n : law.numbers)
    if (n.name == "e_c") {
      points.x.push_back(0.0);
      points.y.push_back(n.estimate.value);
      points.y_error.push_back(half_of(n.estimate));
    }
  for (const MixtureSummary& m : law.mixtures) {
    points.x.push_back(m.ratio);
    points.y.push_back(m.pores.value);
    points.y_error.push_back(half_of(m.pores));
  }
  points.style = {.color = palette::black, .width = 0.0, .marker = Marker::circle};
  if (points.x.empty()) return "";
  plot.add(std::move(points));
  return figure(plot.svg(),
                "Pores that fines leave beside coarse grains, over the solid volume of these; at the left the void "
                "ratio of coarse grains alone. Bars and band: 95 %.");
}

/// How a curve is drawn, by what it measures.
struct CurveLook {
  std::string id;
  std::string title;
  std::string label;
  std::optional<double> low;
  Scale scale = Scale::linear;
  std::string x = "axial strain of the stage [%]";
};

CurveLook look_of(const FrictionCurve& c) {
  if (c.measure == "q/p") return {"cell-law-shear", "Fines sheared at constant volume", "q/p", 0.0};
  if (c.measure == "lateral/axial")
    return {"cell-law-lateral", "Fines in oedometric compression", "lateral over axial stress", 0.0};
  const bool pressure = c.measure == "p/E";
  const auto [least, most] = std::minmax_element(c.measured.begin(), c.measured.end());
  constexpr double kDecade = 10.0;
  const bool far = pressure && !c.measured.empty() && *least > 0.0 && *most > kDecade * *least;
  return {"cell-law-" + c.variant + (pressure ? "-pressure" : "-ratio"),
          c.variant + (pressure ? ", pressure" : ", stress ratio"),
          c.measure,
          std::nullopt,
          far ? Scale::logarithmic : Scale::linear,
          "axial strain [%]"};
}

std::string friction_figure(const FrictionCurve& c) {
  const CurveLook look = look_of(c);
  Plot plot({.id = look.id,
             .title = look.title,
             .x = {.label = look.x},
             .y = {.label = look.label, .scale = look.scale, .low = look.low}});
  std::vector<double> percent;
  for (const double e : c.strain) percent.push_back(100.0 * e);
  Series measured{.label = "grains", .hover = "", .x = percent, .y = c.measured};
  measured.style = {.color = palette::black, .width = 0.0, .marker = Marker::circle};
  bool known = c.error.size() == c.measured.size();
  for (const double e : c.error) known = known && std::isfinite(e);
  if (known) measured.y_error = c.error;
  Series fitted{.label = "cell law", .hover = "", .x = percent, .y = c.fitted};
  fitted.style = {.color = palette::vermillion, .width = 1.8};
  plot.add(std::move(measured));
  plot.add(std::move(fitted));
  return figure(plot.svg(), "Mean over samples ± standard error; the law with the fitted numbers, all cells fines.");
}

std::string mixture_table(const CellLawSummary& law) {
  HtmlTable table(
      {"mixture", "V_f/V_c", "coarse grains", "fine grains (all samples)", "W/V_c", "95 % interval", "fitted"});
  for (const MixtureSummary& m : law.mixtures)
    table.row({m.name, format_number(m.ratio, 3), format_count(m.coarse), format_count(m.fines),
               format_number(m.pores.value, 3), interval_of(m.pores), law.band ? format_number(m.fitted, 3) : "–"});
  return table.empty() ? "" : table.html();
}

std::string preparation_table(const CellLawSummary& law) {
  HtmlTable table({"preparation", "void ratios at the onset over those of the card", "95 % interval"});
  for (const LawNumber& f : law.void_ratio_factors)
    table.row({f.name, format_number(f.estimate.value), interval_of(f.estimate)});
  return table.empty() ? "" : table.html();
}

}  // namespace

std::string cell_law_section(const RunData& run) {
  const CellLawSummary law = run.summary_as<MaterialLawSummary>().law;
  if (law.numbers.empty()) return "";
  std::string body = number_table(law);
  if (!law.usable)
    body += paragraph("Not usable: no card was written; what is missing could not be determined (see the remarks).");
  std::vector<std::string> figures{pores_figure(law)};
  for (const FrictionCurve& c : law.curves) figures.push_back(friction_figure(c));
  body += figure_row(figures) + mixture_table(law) + preparation_table(law);
  if (law.usable)
    body += paragraph(fmt::format(
        "Form: {}. W/V_c is {} about what is fitted (root mean square), the stress ratios of the fines {} about the "
        "law.",
        to_string(law.form), format_number(law.excess_deviation, 2), format_number(law.friction_deviation, 2)));
  return section(
      "cell-law", "Cell law",
      "Pressure over solid fraction of the material between coarse grains: measured packings and the fitted law.",
      body);
}

}  // namespace softgrain::report

namespace softgrain {

namespace {

std::vector<HeadLine> lines_of_law(const report::RunData& run) {
  const auto law = run.summary_as<MaterialLawSummary>().law;
  if (law.numbers.empty()) return {};
  const std::string text = join_text(law.numbers, ", ", [](const LawNumber& n) {
    return n.name + " = " + report::format_number(n.estimate.value, 3);
  });
  return {{"Cell law", text + (law.usable ? "." : "; not usable.")}};
}

std::vector<RunValue> values_of_law(const report::RunData& run) {
  std::vector<RunValue> out;
  for (const LawNumber& n : run.summary_as<MaterialLawSummary>().law.numbers)
    out.push_back({n.name + " of the cell law", "", n.estimate.value, n.estimate.standard_error});
  for (const LawNumber& f : run.summary_as<MaterialLawSummary>().law.void_ratio_factors)
    out.push_back({"void ratios of fines prepared " + f.name + " over those of the cell law", "", f.estimate.value,
                   f.estimate.standard_error});
  return out;
}

NextSteps next_of_law(const report::RunData& run) {
  return {"Take it in a scene with cells of fines: `softgrain macrosim SCENE.toml --law " + run.directory +
              "/cell_law.toml`.",
          "How good it is on mixtures that it has not seen: `softgrain run pipelines/material_vs_models.toml`, whose "
          "variants in `blind` the law does not know."};
}

}  // namespace

KindResults material_law_results() {
  return {.files = {{.names = "cell_law\\.toml", .check = check_laws}},
          .sections = {{Part::laws, report::cell_law_section}},
          .lines = lines_of_law,
          .values = values_of_law,
          .next = next_of_law};
}

}  // namespace softgrain
