#include "macrosim/curve_notes.h"

#include <fmt/format.h>

#include <numeric>

namespace softgrain {

namespace {

/// What was asked and what there is, where they differ.
std::string off_text(const MacroCurve& c, const MacroStage& stage, const Vec3& asked) {
  const Vec3 reached{{c.stress_x.back(), c.stress_y.back(), c.stress_axial.back()}};
  std::string text;
  for (int k = 0; k < 3; ++k)
    if (stage.axis[static_cast<std::size_t>(k)].by_stress)
      text += fmt::format("{}{} {:.4g} Pa asked, {:.4g} Pa reached", text.empty() ? "" : "; ", "xyz"[k], asked[k],
                          reached[k]);
  return text;
}

}  // namespace

void note_out_of_reach(MacroCurve& c, const MacroStage& stage, const Vec3& asked) {
  c.usable = false;
  c.note = fmt::format("stage '{}' ended at axial strain {:.4g}, where its stress was not reached: {} ({})",
                       stage.record.name, c.strain.back(), off_text(c, stage, asked), c.note);
}

void note_relaxation(MacroCurve& c, const RelaxationResult& rest, double strain, double tolerance) {
  if (rest.end == RelaxationEnd::converged) return;
  c.usable = false;
  c.note = "relaxation " + to_string(rest.end) + " at strain " + std::to_string(strain) + " (residual " +
           std::to_string(rest.residual) + " of the mean contact force, wanted " + std::to_string(tolerance) + ")";
}

void record_law_use(MacroCurve& c, const LawUse& use) {
  if (c.grains > 0 || c.soft == 0) return;
  c.law_asked.push_back(static_cast<double>(use.asked));
  c.law_beyond.push_back(static_cast<double>(use.beyond));
  c.law_largest.push_back(use.largest);
}

void note_law_use(MacroCurve& c, const LawUse& last, double strain) {
  LawUse all = last;
  const auto total = [](const std::vector<double>& v) {
    return static_cast<std::int64_t>(std::accumulate(v.begin(), v.end(), 0.0));
  };
  all.asked = total(c.law_asked);
  all.beyond = total(c.law_beyond);
  const std::string text = law_use_text(all);
  if (text.empty()) return;
  if (last.refused > 0) {
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
