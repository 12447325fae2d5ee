#include "macrosim/curve_notes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/core/error.h"
#include "common/core/text.h"
#include "macrosim/test_protocol.h"

namespace softgrain {

namespace {

/// What was asked and what there is, where they differ.
std::string off_text(const MacroCurve& c, const MacroStage& stage, const Vec3& asked) {
  const Vec3 reached{{c.stress_x.back(), c.stress_y.back(), c.stress_axial.back()}};
  std::string text;
  for (int k = 0; k < 3; ++k)
    if (stage.axis[static_cast<std::size_t>(k)].by_stress)
      append_part(text, fmt::format("{} {:.4g} Pa asked, {:.4g} Pa reached", "xyz"[k], asked[k], reached[k]));
  return text;
}

/// Axes that a stage holds at the stress with which it began although there was none, or hardly more than `met` [Pa],
/// to which stresses of the stage are met at best.
void note_free_sides(MacroCurve& c, const MacroStage& stage, std::int64_t number, const Vec3& began, double met) {
  constexpr double kHardlyMore = 10.0;
  std::string none;
  std::string little;
  for (int a = 0; a < 3; ++a) {
    const AxisDrive& drive = stage.axis[static_cast<std::size_t>(a)];
    if (!drive.by_stress || drive.as_at != number || std::abs(began[a]) >= kHardlyMore * met) continue;
    if (began[a] == 0.0)
      append_part(none, std::string(1, "xyz"[a]), ", ");
    else
      append_part(little, fmt::format("{:.3g} Pa along {}", began[a], "xyz"[a]), ", ");
  }
  if (!none.empty())
    append_part(c.note, fmt::format("stage '{}' began without stress along {}, which it holds: its sides are free",
                                    stage.record.name, none));
  if (!little.empty())
    append_part(c.note, fmt::format("stage '{}' began with {}, which it holds to {:.3g} Pa at best: its sides are "
                                    "nearly free",
                                    stage.record.name, little, met));
}

/// A stage that loads under the name of an unloading, or the other way round; `sign`: see way_sign().
void note_wrong_way(MacroCurve& c, const MacroStage& stage, double sign, const Vec3& began) {
  const std::optional<double> target = stage.target_stress();
  const StageKind kind = stage.record.kind;
  if (!target || (kind != StageKind::unload && kind != StageKind::reload)) return;
  const double from = stage.goes_to_mean() ? (began[0] + began[1] + began[2]) / 3.0 : began[2];
  if ((kind == StageKind::unload ? -sign : sign) * (*target - from) >= 0.0) return;
  c.usable = false;
  append_part(c.note, fmt::format("stage '{}' goes from {:.4g} Pa to {:.4g} Pa: it {}, and its modulus is not that of "
                                  "what its kind says",
                                  stage.record.name, from, *target, kind == StageKind::unload ? "loads" : "unloads"));
}

}  // namespace

void note_out_of_reach(MacroCurve& c, const MacroStage& stage, const Vec3& asked) {
  c.usable = false;
  c.note = fmt::format("stage '{}' ended at axial strain {:.4g}, where its stress was not reached: {} ({})",
                       stage.record.name, c.strain.back(), off_text(c, stage, asked), c.note);
}

void note_relaxation(MacroCurve& c, const RelaxationResult& rest, double strain, double tolerance,
                     const std::string& of) {
  if (rest.end == RelaxationEnd::converged) return;
  c.usable = false;
  c.note = fmt::format("relaxation {} at strain {:.6f}{} (residual {:.6f} of the mean contact force, wanted {:.6f})",
                       to_string(rest.end), strain, of, rest.residual, tolerance);
}

void require_finite(const RelaxationResult& rest, const MacroCurve& c) {
  if (std::isfinite(rest.residual)) return;
  throw UnusableResult(fmt::format("macro run '{}': relaxation diverged beyond strain {:.6f}", c.engine,
                                   c.strain.empty() ? 0.0 : c.strain.back()));
}

void note_unrest(MacroCurve& c, const IncrementRest& worst, const MacroStage& stage) {
  const double residual = worst.rest.residual;
  const double largest =
      c.residual_largest.empty() ? 0.0 : *std::max_element(c.residual_largest.begin(), c.residual_largest.end());
  c.residual_largest.resize(c.strain.size() - 1, 0.0);  // a test that an earlier version began did not record it
  c.residual_largest.push_back(residual);
  if (worst.rest.end == RelaxationEnd::converged || (!c.usable && residual < largest)) return;
  const bool one = stage.increments_per_step == 1 || c.residual_largest.size() == 1;
  note_relaxation(
      c, worst.rest, c.strain.back(), stage.tolerance,
      one ? "" : fmt::format(", increment {} of the {} before it", worst.number, stage.increments_per_step));
}

void note_stages(MacroCurve& c, const MacroSpec& spec) {
  const std::vector<MacroStage> stages = stages_of(spec);
  for (std::size_t k = 0; k < stages.size(); ++k) {
    const auto number = static_cast<std::int64_t>(k);
    const auto first = static_cast<std::size_t>(first_point(stages, number));
    if (first + 1 >= c.strain.size()) return;
    const Vec3 began{{c.stress_x[first], c.stress_y[first], c.stress_axial[first]}};
    note_free_sides(c, stages[k], number, began, stress_tolerance(stages[k]) * least_stress(spec));
    note_wrong_way(c, stages[k], way_sign(stages, number), began);
  }
}

std::string stage_names(const MacroSpec& spec, const std::function<bool(const MacroStage&)>& counts) {
  constexpr std::size_t kLongEnough = 60;
  std::string names;
  for (const MacroStage& stage : stages_of(spec))
    if (counts(stage) && names.size() < kLongEnough) append_part(names, "'" + stage.record.name + "'", ", ");
  return names;
}

std::string no_unloading_text(const MacroSpec& spec, const std::string& law) {
  const std::string names =
      stage_names(spec, [](const MacroStage& stage) { return stage.record.kind == StageKind::unload; });
  if (names.empty()) return "";
  return fmt::format(
      "{} has no unloading branch: it gives back what it took, and the unloading modulus of {} is the loading modulus "
      "of the law, not that of the material",
      law, names);
}

void record_law_use(MacroCurve& c, const LawUse& use) {
  if (c.grains > 0 || c.soft == 0) return;
  c.law_evaluations.push_back(static_cast<double>(use.evaluations));
  c.law_beyond.push_back(static_cast<double>(use.beyond));
  c.law_largest.push_back(use.max_range_ratio);
}

void note_law_use(MacroCurve& c, const LawUse& last, double strain) {
  LawUse all = last;
  const auto total = [](const std::vector<double>& v) {
    return static_cast<std::int64_t>(std::accumulate(v.begin(), v.end(), 0.0));
  };
  all.evaluations = total(c.law_evaluations);
  all.beyond = total(c.law_beyond);
  const std::string text = law_use_text(all);
  if (text.empty()) return;
  if (last.rejected > 0) {
    c.usable = false;
    c.note = text + " (strain " + std::to_string(strain) + ")";
  } else if (c.note.empty()) {
    c.note = text;
  }
}

std::string behind_wall_text(const std::string& engine, std::int64_t body, double strain) {
  return "macro run '" + engine + "': the centre of body " + std::to_string(body) + " is behind a wall at strain " +
         std::to_string(strain);
}

}  // namespace softgrain
