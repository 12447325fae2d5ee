#include "pipelines/kinds/grain_box/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "microsim/grain_box/analysis.h"

namespace softgrain {

namespace {

using nlohmann::json;

/// What is not defined is null.
json number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

json point_json(const std::vector<const BoxPoint*>& points, double density) {
  if (points.empty()) return nullptr;
  const BoxPoint& p = *points.back();
  return {{"states", points.size()},
          {"pressure", p.pressure},
          {"stress", p.stress.v},
          {"strain", p.strain.v},
          {"deviator", p.deviator},
          {"shear_stress", p.shear},
          {"wall_moment", p.moment},
          {"solid_fraction", p.solid_fraction},
          {"bulk_density", density * p.solid_fraction},
          {"coordination", p.coordination},
          {"coordination_without_rattlers", p.coordination_without},
          {"rattlers", p.rattlers},
          {"fewest_contacts", p.fewest_contacts},
          {"sliding_share", number(p.sliding_share)},
          {"sliding_limit_at_start", number(p.at_start_limit)},
          {"mean_normal_force", p.mean_force}};
}

/// Means over `points` intervals or arrangements, as `of` says.
json moduli_at_json(const ModuliAt& m, double pressure, const char* of) {
  return {{"pressure", pressure},
          {"K", number(m.bulk)},
          {"K_error", number(m.bulk_error)},
          {"G", number(m.shear)},
          {"G_error", number(m.shear_error)},
          {"mean_normal_force", number(m.force)},
          {"mean_normal_force_error", number(m.force_error)},
          {of, m.points}};
}

json moduli_json(const GrainBoxResult& result, const std::vector<double>& stresses) {
  json out = json::array();
  for (const double stress : stresses)
    if (const ModuliAt m = moduli_at(result, stress); m.points >= 3)
      out.push_back(moduli_at_json(m, stress, "intervals"));
  return out;
}

json fits_json(const GrainBoxResult& result) {
  json out = json_of(fit_growth(result));
  for (json& fit : out) fit.erase("prefactor");  // that of the file, in units that depend on the exponent
  return out;
}

json effort_json(const GrainBoxState& state) {
  const StepEffort e = total_effort(state);
  return {{"states", state.points.size()},
          {"worst_residual", e.residual},
          {"iterations", e.iterations},
          {"loop_passes", e.loop_passes},
          {"contact_evaluations", e.contact_evaluations},
          {"factorisations", e.factorisations},
          {"linear_iterations", e.linear_iterations},
          {"equilibria", e.solutions},
          {"retries", e.retries},
          {"loose_passes", state.loose_passes},
          {"seconds", state.seconds}};
}

json result_json(const GrainBoxResult& result, const std::vector<double>& stresses) {
  json out = {{"name", result.spec.name},
              {"status", result.usable ? "good" : "not usable"},
              {"grains", result.spec.grains},
              {"mu", std::isfinite(result.spec.friction) ? json(result.spec.friction) : json("infinite")},
              {"generation_pressure", result.spec.generation.pressure},
              {"generation_lower_pressures", result.spec.generation.lower_pressures},
              {"test", result.spec.loading.test},
              {"increments", result.spec.loading.increments},
              {"growth_passes", result.state.growth_passes},
              {"after_compaction", point_json(result.points_of(BoxPhase::compaction), result.spec.material.density)},
              {"after_friction", point_json(result.points_of(BoxPhase::friction), result.spec.material.density)},
              {"at_end", point_json(result.points_of(BoxPhase::loading), result.spec.material.density)},
              {"pressure_of_smallest_G", number(pressure_of_smallest_shear(result))},
              {"largest_shear_stress_ratio", largest_over_pressure(result, &BoxPoint::shear)},
              {"largest_wall_moment_ratio", largest_over_pressure(result, &BoxPoint::moment)},
              {"moduli", moduli_json(result, stresses)},
              {"effort", effort_json(result.state)}};
  out["exponents"] = fits_json(result);
  if (!result.usable) out["reason"] = result.reason;
  return out;
}

}  // namespace

nlohmann::json grain_boxes_json(const std::vector<GrainBoxResult>& results) {
  const std::vector<double> stresses = comparison_stresses(results);
  json out = json::array();
  for (const GrainBoxResult& result : results) out.push_back(result_json(result, stresses));
  return out;
}

nlohmann::json arrangements_json(const std::vector<GrainBoxResult>& results) {
  json out = json::array();
  for (const OverArrangements& o : over_arrangements(results)) {
    json moduli = json::array();
    for (const ModuliAt& m : o.moduli)
      if (m.points > 1) moduli.push_back(moduli_at_json(m, m.pressure, "arrangements"));
    out.push_back({{"pack", o.pack},
                   {"arrangements", o.arrangements},
                   {"moduli", moduli},
                   {"sliding_share", number(o.sliding)},
                   {"sliding_share_error", number(o.sliding_error)}});
  }
  return out;
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
