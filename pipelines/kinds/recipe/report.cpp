// A recipe in the report: where the curve is cut, how densely levels pack together, the laws under load. Then what runs
// leave behind.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/data/law_words.h"
#include "pipelines/kinds/law_table/scene.h"
#include "pipelines/kinds/material_law/scene.h"
#include "pipelines/kinds/recipe/mix_run.h"
#include "pipelines/kinds/recipe/onset.h"
#include "pipelines/kinds/recipe/run.h"
#include "pipelines/kinds/recipe/stages.h"
#include "pipelines/report/html.h"
#include "pipelines/report/number_format.h"
#include "pipelines/report/run_data.h"
#include "pipelines/report/svg_plot.h"

namespace softgrain::report {

namespace {

std::string range_of(double low, double high, int digits = 3) {
  return ends_text(low, high, {format_number, digits, " to ", "–", true});
}

std::string constituent_table(const RecipeOutcome& r) {
  std::vector<std::string> heads{"constituent", "share of the mass [%]", "density [kg/m³]",
                                 "share of the solid volume [%]"};
  const bool differ = std::ranges::any_of(r.constituents, [](const auto& c) { return c.youngs_modulus.has_value(); });
  if (differ) heads.insert(heads.end(), {"E [MPa]", "nu", "mu"});
  HtmlTable table(std::move(heads), 1);
  for (const ConstituentSummary& c : r.constituents) {
    std::vector<std::string> row{c.name, format_number(100.0 * c.mass_share, 3), format_number(c.density),
                                 format_number(100.0 * c.volume_share, 3)};
    if (differ)
      row.insert(row.end(), {format_number(1e-6 * c.youngs_modulus.value_or(0.0)),
                             format_number(c.poisson_ratio.value_or(0.0)), format_number(c.friction.value_or(0.0))});
    table.row(row);
  }
  return table.empty() ? "" : table.html();
}

std::string level_table(const RecipeOutcome& r) {
  HtmlTable table({"level", "diameters [mm]", "share of the volume [%]", "grains in a cubic metre", "packing",
                   "onset alone", "onset with all finer", "95 % interval", "finer grains over its voids"});
  for (const RecipeLevelSummary& l : r.levels)
    table.row({std::to_string(l.level), range_of(1e3 * l.diameter_low, 1e3 * l.diameter_high),
               format_number(100.0 * l.share, 3), format_number(l.grains, 2), l.packing, format_number(l.onset, 4),
               format_number(l.with_finer.onset.value, 4), range_of(l.with_finer.onset.low, l.with_finer.onset.high, 4),
               l.filling ? format_number(*l.filling, 2) + (*l.filling > 1.0 ? " (it floats)" : " (it bears)") : "–"});
  return table.html();
}

std::string onset_figure(const RecipeOutcome& r) {
  Plot plot({.id = "recipe-onset",
             .title = "Solid fraction where pressure begins",
             .x = {.label = "largest diameter [mm]", .scale = Scale::logarithmic},
             .y = {.label = "phi_J"}});
  Series band{.label = "level with all finer ones, 95 %", .hover = "", .x = {}, .y = {}};
  Series levels{.label = "by levels", .hover = "", .x = {}, .y = {}};
  Series rods{.label = "by rods", .hover = "", .x = {}, .y = {}};
  Series alone{.label = "level alone, measured", .hover = "", .x = {}, .y = {}};
  for (auto l = r.levels.rbegin(); l != r.levels.rend(); ++l) {
    const double x = 1e3 * l->diameter_high;
    for (Series* s : {&band, &levels, &rods, &alone}) s->x.push_back(x);
    band.y.push_back(l->with_finer.onset.value);
    band.band_low.push_back(l->with_finer.onset.low);
    band.band_high.push_back(l->with_finer.onset.high);
    levels.y.push_back(l->with_finer.levels);
    rods.y.push_back(l->with_finer.rods);
    alone.y.push_back(l->onset);
  }
  if (!std::isfinite(band.band_low.front())) band.band_low.clear(), band.band_high.clear();
  band.style = {.color = palette::blue, .width = 2.0};
  levels.style = {.color = palette::green, .width = 1.2, .dash = "5 3"};
  rods.style = {.color = palette::orange, .width = 1.2, .dash = "2 3"};
  alone.style = {.color = palette::vermillion, .width = 0.0, .marker = Marker::circle};
  for (Series* s : {&band, &levels, &rods, &alone}) plot.add(std::move(*s));
  if (r.check) {
    Series check{.label = "check, all its grains",
                 .hover = "",
                 .x = {1e3 * r.levels.front().diameter_high},
                 .y = {r.check->measured.value}};
    check.style = {.color = palette::black, .width = 0.0, .marker = Marker::diamond, .marker_size = 5.0};
    plot.add(std::move(check));
  }
  return figure(
      plot.svg(),
      "From the finest level (left) up: each with everything finer, by two ways of putting levels together. The "
      "check holds the coarsest levels alone, and lies below the whole where finer ones are missing in it.");
}

/// What stresses over E are multiplied with, and what they are in then: MPa with stages.
struct StressUnit {
  double factor = 1.0;
  std::string text = "E";
};

StressUnit stress_unit(const RecipeSummary& s) {
  constexpr double kMega = 1e-6;
  if (!s.recipe.staged) return {};
  return {kMega * s.material.youngs_modulus.value_or(0.0), "MPa"};
}

std::string load_figure(const RecipeOutcome& r, const StressUnit& unit) {
  Plot plot({.id = "recipe-load",
             .title = "Pressed between rigid sides",
             .x = {.label = "axial strain [%]"},
             .y = {.label = r.staged ? "axial stress [MPa]" : "axial stress over E", .scale = Scale::logarithmic}});
  std::size_t color = 0;
  for (const RecipeCurve& c : r.curves) {
    if (c.strain.empty()) continue;
    Series s{.label = c.name, .hover = "", .x = c.strain, .y = c.axial, .band_low = c.low, .band_high = c.high};
    for (double& x : s.x) x *= 100.0;
    for (double& low : s.band_low) low = std::max(low, 1e-6);
    for (auto* stresses : {&s.y, &s.band_low, &s.band_high})
      for (double& stress : *stresses) stress *= unit.factor;
    s.style = {.color = palette::cycle(++color), .width = 1.8};
    plot.add(std::move(s));
  }
  if (plot.empty()) return "";
  return figure(
      plot.svg(),
      std::string(r.staged ? "Material law: what packings do, from the onset of the whole. "
                           : "Material law: the equation of state from its onset. ") +
          "Cell law: grains of the coarsest level in cells of "
          "everything finer. Shell law, where there is one: the same grains with soft particles that keep their "
          "shells between them: another material, whose fines cannot leave the room that they were given.");
}

std::string shell_table(const RecipeOutcome& r) {
  HtmlTable table({"level of the shell hierarchy", "diameters [mm]", "one plane at h/Rs = 0.2 [F/(E Rs²)]",
                   "grains that a soft particle stands for"});
  for (const ShellLevelSummary& l : r.shells)
    table.row({std::to_string(l.level), range_of(1e3 * l.diameter_low, 1e3 * l.diameter_high),
               format_number(l.force, 3), format_number(l.grains, 3)});
  return table.empty() ? "" : table.html();
}

std::string modulus_table(const RecipeOutcome& r, const StressUnit& unit) {
  HtmlTable table(
      {"curve", "constrained modulus [" + unit.text + "]", "95 %", "between axial stresses [" + unit.text + "]"}, 1);
  const double f = unit.factor;
  for (const RecipeCurve& c : r.curves)
    if (c.modulus)
      table.row({c.name, format_number(f * c.modulus->value, 3), range_of(f * c.modulus->low, f * c.modulus->high),
                 format_number(f * c.modulus->from, 3) + " and " + format_number(f * c.modulus->to, 3)});
  return table.empty() ? "" : table.html();
}

/// "544 (480–610)", with what all grains were measured to be behind it.
std::string predicted_text(const PredictedValue& v, double unit) {
  if (!std::isfinite(v.predicted.value)) return "–";
  std::string text = format_number(unit * v.predicted.value, 3) + " (" +
                     range_of(unit * v.predicted.low, unit * v.predicted.high) + ")";
  if (v.measured) text += "; all grains " + format_number(unit * v.measured->mean, 3);
  return text;
}

std::string stage_table(const RecipeStages& staged) {
  constexpr double kMega = 1e-6;
  HtmlTable table({"stage", "to [MPa]", "K0", "void ratio", "constrained modulus [MPa]", "between [MPa]",
                   "Cc; unloading and reloading: Cs", "tangent at the end [MPa]"},
                  1);
  for (const RecipeStageSummary& s : staged.stages)
    table.row({s.name, format_number(kMega * s.stress_end, 3), predicted_text(s.lateral_ratio, 1.0),
               predicted_text(s.void_ratio, 1.0), predicted_text(s.secant, kMega),
               format_number(kMega * s.stress_from, 3) + " and " + format_number(kMega * s.stress_to, 3),
               predicted_text(s.index, 1.0), predicted_text(s.tangent_end, kMega)});
  return table.html();
}

std::string void_ratio_figure(const RecipeStages& staged) {
  Plot plot({.id = "recipe-void-ratio",
             .title = "Void ratio under axial stress",
             .x = {.label = "axial stress [MPa]", .scale = Scale::logarithmic},
             .y = {.label = "void ratio"}});
  std::size_t color = 0;
  std::size_t k = 0;
  for (const RecipeStageSummary& stage : staged.stages) {
    Series s{.label = stage.name, .hover = "", .x = {}, .y = {}};
    for (k -= k > 0 ? 1 : 0; k < staged.points.size() && (s.x.empty() || staged.points[k].stage == stage.name); ++k) {
      const RecipePoint& p = staged.points[k];
      s.x.push_back(1e-6 * p.axial);
      s.y.push_back(p.void_ratio.value);
      s.band_low.push_back(p.void_ratio.low);
      s.band_high.push_back(p.void_ratio.high);
    }
    if (std::ranges::none_of(s.band_low, [](double low) { return std::isfinite(low); }))
      s.band_low.clear(), s.band_high.clear();
    s.style = {.color = palette::cycle(++color), .width = 1.8};
    plot.add(std::move(s));
  }
  return figure(plot.svg(),
                "The whole, stage by stage. The band is the 95 % interval: mostly of the onset, so that "
                "all points lie high or low together.");
}

std::string whole_text(const RecipeOutcome& r) {
  std::string text = fmt::format(
      "The whole begins to carry pressure at a solid fraction of {} ({}): {} by levels, {} by rods (gap {}; packings "
      "lie {} about them). At the start pressure it is {} ({}). Lateral over axial stress where the {}, by mixtures of "
      "two levels: {} ({}).",
      format_number(r.onset->value, 4), range_of(r.onset->low, r.onset->high, 4),
      format_number(r.levels.front().with_finer.levels, 4), format_number(r.levels.front().with_finer.rods, 4),
      format_number(r.gap, 3), format_number(r.rods_deviation, 2), format_number(r.solid_fraction->value, 4),
      range_of(r.solid_fraction->low, r.solid_fraction->high, 4), r.staged ? "stress is highest" : "test ends",
      format_number(r.lateral_ratio.value, 3), range_of(r.lateral_ratio.low, r.lateral_ratio.high));
  if (r.compressible_model)
    text += " The compressible packing model (de Larrard 1999), a model of others, gives " +
            compressible_model_text(*r.compressible_model) + ".";
  text += fmt::format(
      " A cubic metre holds {} grains; a sample with a hundred of them above a third of the largest diameter {}, which "
      "would take about {} contact evaluations, by what grains took here.",
      format_number(r.grains_per_cubic_metre, 2), format_number(r.resolved_grains, 2),
      format_number(r.resolved_evaluations, 2));
  return text;
}

std::string ratio_text(const std::optional<PredictedValue>& ratio) {
  if (!ratio || !ratio->measured) return "";
  return fmt::format(" Its lateral over axial stress is {} (predicted {} ({}): {}).", with_error(*ratio->measured),
                     format_number(ratio->predicted.value, 3), range_of(ratio->predicted.low, ratio->predicted.high),
                     ratio->inside() ? "inside" : "outside");
}

std::string check_text(const RecipeCheckSummary& c) {
  return fmt::format(
      "Check: the {} coarsest levels with all their grains ({} of span {}) begin to carry pressure at {}; put together "
      "from levels {} ({}): {}. By levels it is {}, by rods {}; {}.",
      c.levels, format_count(c.grains), format_number(c.span, 3), format_number(c.measured.value, 4),
      format_number(c.predicted.onset.value, 4), range_of(c.predicted.onset.low, c.predicted.onset.high, 4),
      c.outside > 0.0 ? "outside by " + format_number(c.outside, 2) + ", and all intervals here are widened by that"
                      : "inside",
      format_number(c.predicted.levels, 4), format_number(c.predicted.rods, 4),
      c.weighs
          ? "by that the value of the whole has a share of " + format_number(c.share_of_rods, 2) + " of the rods"
          : "between levels that were measured together it does not tell which way does better over more of them: the "
            "value of the whole is the middle of both");
}

}  // namespace

std::string recipe_section(const RunData& run) {
  const auto summary = run.summary_as<RecipeSummary>();
  const RecipeOutcome& r = summary.recipe;
  if (r.levels.empty() || !r.onset) return "";
  const StressUnit unit = stress_unit(summary);
  std::string body = paragraph(whole_text(r));
  if (r.check) body += paragraph(check_text(*r.check) + ratio_text(r.check->lateral_ratio));
  if (r.staged) body += stage_table(*r.staged);
  std::vector<std::string> figures{onset_figure(r), load_figure(r, unit)};
  if (r.staged) figures.push_back(void_ratio_figure(*r.staged));
  body += figure_row(figures);
  body += modulus_table(r, unit) + constituent_table(r) + level_table(r) + shell_table(r);
  return section("recipe", "From the recipe to the law",
                 "From the particle size distribution to the law: the levels, their onset and, where it was made, the "
                 "check with all grains.",
                 body);
}

}  // namespace softgrain::report

namespace softgrain {

namespace {

std::vector<HeadLine> lines_of(const report::RunData& run) {
  const auto r = run.summary_as<RecipeSummary>().recipe;
  if (r.levels.empty() || !r.onset) return {};
  std::vector<HeadLine> out{
      {"Recipe",
       fmt::format("{} levels, largest over smallest {}; begins to carry pressure at a solid fraction of {}; a "
                   "cubic metre holds {} grains.",
                   r.levels.size(), report::format_number(r.span, 3), interval_text(*r.onset),
                   report::format_number(r.grains_per_cubic_metre, 2))}};
  if (!r.staged) return out;
  constexpr double kMega = 1e-6;
  for (const RecipeStageSummary& s : r.staged->stages)
    out.push_back({fmt::format("{} to {:.4g} MPa", s.name, kMega * s.stress_end),
                   fmt::format("constrained modulus {} MPa from {:.4g} to {:.4g} MPa, K0 {}, void ratio {}.",
                               value_text(s.secant, kMega), kMega * s.stress_from, kMega * s.stress_to,
                               value_text(s.lateral_ratio, 1.0), value_text(s.void_ratio, 1.0))});
  return out;
}

std::vector<RunValue> values_of(const report::RunData& run) {
  const auto r = run.summary_as<RecipeSummary>().recipe;
  std::vector<RunValue> out;
  if (r.onset) out.push_back({"onset of the whole", "", r.onset->value, r.onset->standard_error});
  const auto add_packing = [&] {
    if (r.compressible_model) {
      out.push_back({"compressible packing model, K = 4.1", "", r.compressible_model->poured});
      out.push_back({"compressible packing model, K = 9", "", r.compressible_model->vibrated_pressed});
    }
    if (r.solid_fraction)
      out.push_back({"solid fraction at the start", "", r.solid_fraction->value, r.solid_fraction->standard_error});
  };
  if (r.staged) {
    for (const RecipeStageSummary& s : r.staged->stages)
      for (const StageQuantity& q : quantities_of(s))
        if (std::isfinite(q.value.value)) out.push_back({q.name, q.unit, q.value.value, q.value.standard_error});
    add_packing();
    return out;
  }
  for (const RecipeCurve& c : r.curves)
    if (!c.axial.empty()) out.push_back({"axial stress over E at the end, " + c.name, "", c.axial.back()});
  for (const RecipeCurve& c : r.curves)
    if (c.modulus) out.push_back({"constrained modulus over E, " + c.name, "", c.modulus->value});
  if (r.onset) out.push_back({"K0 at the end", "", r.lateral_ratio.value, r.lateral_ratio.standard_error});
  if (r.check && r.check->lateral_ratio && r.check->lateral_ratio->measured)
    out.push_back({"K0 at the end, all grains of the check", "", r.check->lateral_ratio->measured->mean,
                   r.check->lateral_ratio->measured->error});
  add_packing();
  return out;
}

std::vector<RunCurve> curves_of(const report::RunData& run) {
  std::vector<RunCurve> out;
  const auto summary = run.summary_as<RecipeSummary>();
  const report::StressUnit unit = report::stress_unit(summary);
  for (const RecipeCurve& c : summary.recipe.curves)
    if (!c.strain.empty()) {
      RunCurve curve;
      curve.plot = "Recipe under oedometric load";
      curve.x_label = "axial strain";
      curve.y_label = summary.recipe.staged ? "axial stress [MPa]" : "axial stress over E";
      curve.name = c.name;
      curve.x = c.strain;
      curve.y = c.axial;
      for (double& stress : curve.y) stress *= unit.factor;
      out.push_back(std::move(curve));
    }
  return out;
}

NextSteps next_of(const report::RunData& run) {
  const bool cells = run.summary_as<RecipeSummary>().material.head.files.contains("cell_law");
  return {cells ? "The coarsest level among all finer ones in a scene of your own: `softgrain macrosim SCENE.toml "
                  "--law " +
                      run.directory + "/cell_law.toml`."
                : "There is no cell law: the warning says why. More grains: `softgrain run SCENE.toml --set "
                  "grains.count=4000`.",
          "How far from converged: `softgrain run SCENE.toml --set samples=4 --set grains.count=4000`; how far the law "
          "holds: a larger check, `--set check.grains=80000`."};
}

}  // namespace

KindResults recipe_results() {
  return {.files = {{.names = "recipe(\\.csv|_stages\\.csv|_macro\\.h5)"},
                    {.names = "material_card\\.toml", .check = check_laws}},
          .sections = {{Part::several, report::recipe_section}},
          .lines = lines_of,
          .values = values_of,
          .curves = curves_of,
          .differences = recipe_differences,
          .next = next_of};
}

}  // namespace softgrain
