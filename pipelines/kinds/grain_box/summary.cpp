#include "pipelines/kinds/grain_box/summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipelines/kinds/grain_box/scene.h"

namespace softgrain {

namespace {

std::optional<PhaseSummary> last_state(const GrainBoxResult& result, BoxPhase phase) {
  const std::vector<const BoxPoint*> points = result.points_of(phase);
  if (points.empty()) return std::nullopt;
  return PhaseSummary{points.size(), *points.back(), result.spec.material.density};
}

std::vector<ModuliSummary> moduli_of(const GrainBoxResult& result, const std::vector<double>& stresses) {
  std::vector<ModuliSummary> out;
  for (const double stress : stresses) {
    ModuliAt m = moduli_at(result, stress);
    if (m.points < 3) continue;
    m.pressure = stress;
    out.push_back({m});
  }
  return out;
}

BoxSummary summary_of(const GrainBoxResult& result, const std::vector<double>& stresses) {
  const GrainBoxSpec& spec = result.spec;
  const GrainBoxState& state = result.state;
  BoxSummary out{.name = spec.name,
                 .status = result.usable ? RunStatus::good : RunStatus::not_usable,
                 .grains = spec.grains,
                 .friction = std::isfinite(spec.friction) ? nlohmann::json(spec.friction) : nlohmann::json("infinite"),
                 .generation = spec.generation,
                 .test = spec.loading.test,
                 .increments = spec.loading.increments,
                 .growth_passes = state.growth_passes,
                 .after_compaction = last_state(result, BoxPhase::compaction),
                 .after_friction = last_state(result, BoxPhase::friction),
                 .at_end = last_state(result, BoxPhase::loading),
                 .pressure_of_smallest_shear = pressure_of_smallest_shear(result),
                 .largest_shear = largest_over_pressure(result, &BoxPoint::shear),
                 .largest_moment = largest_over_pressure(result, &BoxPoint::moment),
                 .moduli = moduli_of(result, stresses),
                 .effort = {state.points.size(), total_effort(state), state.loose_passes, state.seconds},
                 .exponents = {fit_growth(result)}};
  if (!result.usable) out.reason = result.reason;
  return out;
}

}  // namespace

std::vector<BoxSummary> summaries_of(const std::vector<GrainBoxResult>& results) {
  const std::vector<double> stresses = comparison_stresses(results);
  std::vector<BoxSummary> out;
  for (const GrainBoxResult& result : results) out.push_back(summary_of(result, stresses));
  return out;
}

std::vector<ArrangementsSummary> arrangements_of(const std::vector<GrainBoxResult>& results) {
  std::vector<ArrangementsSummary> out;
  for (const OverArrangements& over : over_arrangements(results)) {
    out.push_back({over, {}});
    for (const ModuliAt& m : over.moduli)
      if (m.points > 1) out.back().moduli.push_back({m, true});
  }
  return out;
}

std::string arrangements_text(const std::vector<OverArrangements>& packs) {
  const ErrorForm in_gpa{.value = {4}, .error = {2}};
  std::string text;
  for (const OverArrangements& over : packs) {
    text += fmt::format("{}, mean of {} arrangements +- standard error:", over.pack, over.arrangements);
    const auto last =
        std::ranges::find_if(over.moduli.rbegin(), over.moduli.rend(), [](const ModuliAt& m) { return m.points > 1; });
    if (last != over.moduli.rend())
      text += fmt::format(" at sigma_c {:.4g} MPa K {} GPa, G {} GPa;", last->pressure * 1e-6,
                          with_error(last->bulk * 1e-9, last->bulk_error * 1e-9, in_gpa),
                          with_error(last->shear * 1e-9, last->shear_error * 1e-9, in_gpa));
    text +=
        fmt::format(" sliding {}\n", with_error(over.sliding, over.sliding_error, {.error = {2}, .undefined = "-"}));
  }
  return text;
}

std::vector<std::string> grain_box_remarks(const std::vector<GrainBoxResult>& results) {
  std::vector<std::string> remarks;
  for (const GrainBoxResult& r : results)  // first, as the first remark is taken for the reason
    if (!r.usable) remarks.push_back(fmt::format("pack '{}' broke off: {}", r.spec.name, r.reason));
  for (const GrainBoxResult& r : results) {
    if (!r.state.failures.empty())
      remarks.push_back(
          fmt::format("pack '{}': {} tries of increments did not reach equilibrium and were halved or repeated; "
                      "they are listed in grain_box.h5",
                      r.spec.name, r.state.failures.size()));
    const double shear = largest_over_pressure(r, &BoxPoint::shear);
    if (shear > 0.02)
      remarks.push_back(fmt::format(
          "pack '{}': shear stresses by the moments of the wall forces reach {:.1f} % of the confining stress; more "
          "grains have less",
          r.spec.name, 100.0 * shear));
    const double moment = largest_over_pressure(r, &BoxPoint::moment);
    if (moment > 1e-2)
      remarks.push_back(fmt::format(
          "pack '{}': the moment of the wall forces reaches {:.1f} % of the confining stress times the volume: a lower "
          "solver.tolerance",
          r.spec.name, 100.0 * moment));
  }
  return remarks;
}

}  // namespace softgrain
