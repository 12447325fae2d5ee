// What the stages of macro tests came to: moduli, strength, change of volume.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "common/core/few_samples.h"
#include "pipelines/compare/stage_results.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/plot_helpers.h"

namespace softgrain::report {

namespace {

/// A quantity that curves do not hold, in the place of one that they do.
template <class Quantity>
std::vector<MacroCurve> with_column(std::vector<MacroCurve> curves, Stress member, Quantity&& of) {
  for (MacroCurve& c : curves) c.*member = of(c);
  return curves;
}

std::vector<double> volumetric_strains(const MacroCurve& c) {
  std::vector<double> out;
  for (std::size_t k = 0; k < c.strain_x.size(); ++k)
    out.push_back(100.0 * (1.0 - (1.0 - c.strain_x[k]) * (1.0 - c.strain_y[k]) * (1.0 - c.strain_z[k])));
  return out;
}

/// Where a quantity stands that curves do not hold, for add_curves().
constexpr Stress kPlace = &MacroCurve::stress_deviator;

/// A quantity over the strain that drives the stages: where some slide, in two figures.
template <class Quantity>
std::vector<std::string> over_strain(const std::vector<MacroCurve>& curves, const std::string& id, const char* title,
                                     const char* label, const char* caption, Quantity&& of) {
  const std::vector<MacroCurve> all = with_column(curves, kPlace, of);
  std::vector<std::string> figures;
  for (const StrainPart part : kPartsOfStages) {
    const bool sliding = part == StrainPart::shear;
    Plot plot({.id = sliding ? id + "-sliding" : id,
               .title = std::string(title) + (sliding ? " that slide" : ""),
               .x = {.label = strain_label(part, MacroTest::stages)},
               .y = {.label = label},
               .height = 310.0});
    add_curves(plot, all, kPlace, 1.0, part);
    if (!plot.empty()) figures.push_back(figure(plot.svg(), caption));
  }
  return figures;
}

std::string cell(const std::optional<MeanError>& m, double unit = 1.0) {
  return m ? format_with_error(m->mean / unit, m->n > 1 ? m->error / unit : 0.0) : "–";
}

/// The stresses that a secant modulus was taken between, or those that the stage did not go through.
std::string between(const StageMeans& s, double unit) {
  const std::string words = modulus_interval(s);
  if (!s.modulus) return "not met: " + words;
  return format_number(s.modulus_from->mean / unit, 3) + " and " + format_number(s.modulus_to->mean / unit, 3) +
         (s.record.modulus_stress[1] > 0.0 ? "" : " (" + words + ")");
}

/// A slope whose error is as large as itself is none.
std::string slope_cell(const std::optional<MeanError>& m, double unit = 1.0) {
  return !m || is_told_from_zero(m->n, m->mean, m->error) ? cell(m, unit) : "not determined (" + cell(m, unit) + ")";
}

/// The part of tests with stages that slide: shear stress over that along z, over the shear strain.
std::string sliding_figure(std::vector<MacroCurve> curves) {
  std::erase_if(curves, [](const MacroCurve& c) {
    return c.shear_strain.size() != c.strain.size() || c.stress_xz.size() != c.strain.size();
  });
  Plot plot({.id = "macro-sliding-ratio",
             .title = "Shear stress over normal stress",
             .x = {.label = "shear strain [%]"},
             .y = {.label = "σxz/σz"},
             .height = 310.0});
  const auto ratio = [](const MacroCurve& c) {
    std::vector<double> out;
    for (std::size_t k = 0; k < c.strain.size(); ++k)
      out.push_back(c.stress_axial[k] > 0.0 ? c.stress_xz[k] / c.stress_axial[k] : kNaN);
    return out;
  };
  add_curves(plot, with_column(std::move(curves), kPlace, ratio), kPlace, 1.0, StrainPart::shear);
  return plot.empty() ? "" : figure(plot.svg(), "The friction that is mobilised on planes normal to z.");
}

/// Columns with their prefixes, and what a stage has in them; nothing: it has no row.
struct StageTable {
  std::vector<std::string> header;
  std::function<std::vector<std::string>(const StageMeans&)> cells;
};

std::string table_of(const std::vector<MacroCurve>& curves, const StageTable& wanted) {
  std::vector<std::string> header{"stage", "engine"};
  header.insert(header.end(), wanted.header.begin(), wanted.header.end());
  HtmlTable table(header, 2);
  std::vector<std::string> engines;
  for (const MacroCurve& c : curves)
    if (std::find(engines.begin(), engines.end(), c.engine) == engines.end()) engines.push_back(c.engine);
  for (const std::string& engine : engines)
    for (const StageMeans& s : stage_means(curves, engine)) {
      std::vector<std::string> row{s.record.name, engine_name(engine)};
      std::vector<std::string> cells = wanted.cells(s);
      if (cells.empty()) continue;
      for (std::string& one : cells) row.push_back(std::move(one));
      table.row(row);
    }
  return table.empty() ? "" : table.html();
}

std::string tables_of_stages(const std::vector<MacroCurve>& curves) {
  double largest = 0.0;
  for (const MacroCurve& c : curves)
    for (const double s : c.stress_axial) largest = std::max(largest, std::abs(s));
  const SiPrefix stress = si_prefix(largest);
  const SiPrefix modulus = si_prefix(10.0 * largest);
  const std::string stress_unit = " [" + stress.symbol + "Pa]";
  const std::string modulus_unit = " [" + modulus.symbol + "Pa]";
  const StageTable moduli{{"modulus", "secant" + modulus_unit, "between stresses" + stress_unit,
                           "tangent at its begin" + modulus_unit, "Poisson's ratio at its begin"},
                          [&](const StageMeans& s) -> std::vector<std::string> {
                            const bool holds = s.record.kind == StageKind::hold;
                            return {holds ? "–" : to_string(modulus_of(s.record.way)),
                                    slope_cell(s.modulus, modulus.factor), holds ? "–" : between(s, stress.factor),
                                    slope_cell(s.modulus_begin, modulus.factor), slope_cell(s.poisson_begin)};
                          }};
  const StageTable ends{
      {"axial strain [%]", "volume lost [%]", "axial stress" + stress_unit, "lateral stress" + stress_unit, "K0", "q/p",
       "largest q/p"},
      [&](const StageMeans& s) -> std::vector<std::string> {
        const std::string where =
            s.ratio_peak_strain ? " at " + format_number(100.0 * s.ratio_peak_strain->mean, 3) + " %" : "";
        return {cell(s.strain_end, 0.01),           cell(s.volumetric_end, 0.01), cell(s.axial_end, stress.factor),
                cell(s.lateral_end, stress.factor), cell(s.lateral_ratio),        cell(s.ratio_end),
                cell(s.ratio_peak) + where};
      }};
  const StageTable sliding{
      {"shear strain [%]", "σxz/σz at the end", "largest σxz/σz", "angle of friction [°]"},
      [](const StageMeans& s) -> std::vector<std::string> {
        if (!s.shear_end) return {};
        const std::string where =
            s.friction_peak_shear ? " at " + format_number(100.0 * s.friction_peak_shear->mean, 3) + " %" : "";
        return {cell(s.shear_end, 0.01), cell(s.friction_end), cell(s.friction_peak) + where,
                s.friction_peak ? format_number(180.0 / std::numbers::pi * std::atan(s.friction_peak->mean), 3) : "–"};
      }};
  const bool slides = std::ranges::any_of(curves, [](const MacroCurve& c) { return !c.shear_strain.empty(); });
  const std::string text =
      table_of(curves, moduli) + table_of(curves, ends) + (slides ? table_of(curves, sliding) : "");
  if (text.empty()) return "";
  return text +
         paragraph(
             "Moduli are over logarithmic strains: constrained Δσz/Δεz, Young Δσz/Δεz at constant lateral stress, bulk "
             "Δp/Δεv, shear Δ(σz − σx)/2Δ(εz − εx) or, sliding, Δσxz/Δγ, undrained Young Δ(σz − (σx + σy)/2)/Δεz. The "
             "secant is taken between two values of that stress (p of bulk, "
             "(σz − σx)/2 of shear), which modulus_stress of the scene chooses. The tangent is that of a parabola "
             "through the first points; of an unloading it is the unloading modulus. The second table has what there "
             "is at the end of each stage, K0 = σx/σz where x and y stand, and the largest q/p with the axial strain "
             "where it is; q = √(3J₂), p the "
             "mean stress. Mean over usable samples ± standard error; one sample has none.");
}

}  // namespace

std::string stage_parts(const std::vector<MacroCurve>& curves, MacroTest test) {
  std::string out;
  if (test == MacroTest::stages) {
    const auto ratios =
        over_strain(curves, "macro-stages-ratio", "Stress ratio, stages", "q/p", "q/p, the strength that is mobilised.",
                    [](const MacroCurve& c) { return stress_ratios(c); });
    const auto volumes =
        over_strain(curves, "macro-stages-volume", "Volume, stages", "volume lost [%]",
                    "Loss of volume since the start; where it falls, the packing dilates.", volumetric_strains);
    for (std::size_t k = 0; k < std::max(ratios.size(), volumes.size()); ++k)
      out += figure_row({k < ratios.size() ? ratios[k] : "", k < volumes.size() ? volumes[k] : ""});
  }
  return out + figure_row({sliding_figure(curves)}) + tables_of_stages(curves);
}

}  // namespace softgrain::report
