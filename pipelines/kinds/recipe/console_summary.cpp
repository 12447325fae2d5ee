// What a run of a recipe says in the terminal.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "common/data/law_words.h"
#include "pipelines/kinds/recipe/onset.h"
#include "pipelines/kinds/recipe/run.h"

namespace softgrain {

std::string value_text(const PredictedValue& v, double unit) {
  const Estimate& e = v.predicted;
  std::string text = interval_text(e.value * unit, e.low * unit, e.high * unit);
  if (v.measured) text += fmt::format(" [all grains {:.4g}]", v.measured->mean * unit);
  return text;
}

namespace {

std::string stages_summary(const RecipeStages& staged) {
  constexpr double kMega = 1e-6;
  std::string text;
  for (const RecipeStageSummary& s : staged.stages) {
    text += fmt::format("  {} to {:.4g} MPa: K0 {}, void ratio {}\n", s.name, kMega * s.stress_end,
                        value_text(s.lateral_ratio, 1.0), value_text(s.void_ratio, 1.0));
    text +=
        fmt::format("    constrained modulus {} MPa, {} {} from {:.4g} to {:.4g} MPa\n", value_text(s.secant, kMega),
                    s.index_name(), value_text(s.index, 1.0), kMega * s.stress_from, kMega * s.stress_to);
    text += fmt::format("    tangent at the first point {} MPa, at the last {} MPa\n",
                        value_text(s.tangent_begin, kMega), value_text(s.tangent_end, kMega));
  }
  return text;
}

/// Stress of a curve, over E; with stages in MPa.
std::string stress_text(const RecipeCurve& c, std::size_t k, double modulus, bool staged) {
  return staged ? fmt::format("{:.4g} MPa", 1e-6 * modulus * c.axial[k]) : fmt::format("{:.3g} E", c.axial[k]);
}

/// Levels and the check.
std::string levels_summary(const RecipeOutcome& r) {
  std::string text;
  for (const RecipeLevelSummary& level : r.levels) {
    text +=
        fmt::format("  level {}: {:.3g} to {:.3g} mm, {:.3g} % of the volume, phi_J alone {:.4f}, with all finer {}",
                    level.level, 1e3 * level.diameter_low, 1e3 * level.diameter_high, 100.0 * level.share, level.onset,
                    interval_text(level.with_finer.onset));
    if (level.filling)
      text += fmt::format("; finer grains take up {:.2g} times its voids{}", *level.filling,
                          *level.filling > 1.0 ? ": it floats" : ": it bears");
    text += "\n";
  }
  if (r.check)
    text += fmt::format(
        "  check: {} levels with all grains ({}, span {:.3g}): phi_J = {:.4f}, predicted {} (levels {:.4f}, rods "
        "{:.4f}){}\n",
        r.check->levels, r.check->grains, r.check->span, r.check->measured.value,
        interval_text(r.check->predicted.onset), r.check->predicted.levels, r.check->predicted.rods,
        r.check->outside > 0.0 ? ": OUTSIDE" : "");
  if (r.check && r.check->lateral_ratio) {
    const PredictedValue& ratio = *r.check->lateral_ratio;
    text += fmt::format("  check: K0 {} = {:.3f}, predicted {}{}\n", r.staged ? "at the highest stress" : "at the end",
                        ratio.measured->mean, interval_text(ratio.predicted), ratio.inside() ? "" : ": OUTSIDE");
  }
  return text;
}

/// Loads by all laws.
std::string curves_summary(const RecipeOutcome& r, double modulus) {
  const bool staged = r.staged.has_value();
  std::string text;
  for (const RecipeCurve& c : r.curves) {
    if (c.axial.empty()) continue;
    const auto k =
        staged ? static_cast<std::size_t>(std::ranges::max_element(c.axial) - c.axial.begin()) : c.axial.size() - 1;
    text += fmt::format("  {}: axial stress {}{} at a strain of {:.3g}", c.name, stress_text(c, k, modulus, staged),
                        c.low.empty() || staged       ? ""
                        : std::isfinite(c.low.back()) ? fmt::format(" ({:.3g} to {:.3g})", c.low.back(), c.high.back())
                                                      : " (extrapolated: no interval)",
                        c.strain[k]);
    if (c.modulus && !staged)
      text +=
          fmt::format("; constrained modulus {} E from {:.3g} to {:.3g} E",
                      interval_text(c.modulus->value, c.modulus->low, c.modulus->high), c.modulus->from, c.modulus->to);
    text += "\n";
  }
  return text;
}

}  // namespace

std::string console_summary(const RecipeSummary& s) {
  const RecipeOutcome& r = s.recipe;
  std::string text = levels_summary(r);
  if (!r.onset) return text;
  text +=
      fmt::format("the whole, span {:.3g}: phi_J = {} (levels {:.4f}, rods {:.4f}), solid fraction at the start {}\n",
                  r.span, interval_text(*r.onset), r.levels.front().with_finer.levels, r.levels.front().with_finer.rods,
                  interval_text(*r.solid_fraction));
  if (!r.staged)
    text += fmt::format("  K0 at the end, by mixtures of two levels: {}\n", interval_text(r.lateral_ratio));
  if (r.compressible_model)
    text += "  beside it the compressible packing model (de Larrard 1999), a model of others: " +
            compressible_model_text(*r.compressible_model) + "\n";
  if (r.staged) text += stages_summary(*r.staged);
  text += curves_summary(r, s.material.youngs_modulus.value_or(0.0));
  for (const ShellLevelSummary& level : r.shells)
    text += fmt::format(
        "  shell hierarchy, level {}: {:.3g} to {:.3g} mm, one plane {:.3g} E Rs^2 at h/Rs = 0.2, {:.3g} "
        "grains\n",
        level.level, 1e3 * level.diameter_low, 1e3 * level.diameter_high, level.force, level.grains);
  text += fmt::format(
      "a cubic metre holds {:.2g} grains; a sample with all of them: {:.2g}, about {:.2g} contact evaluations\n",
      r.grains_per_cubic_metre, r.resolved_grains, r.resolved_evaluations);
  return text;
}

}  // namespace softgrain
