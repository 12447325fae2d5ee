#include "pipelines/law/law_json.h"
#include "common/io/json_number.h"

#include <cmath>
#include <numbers>

namespace softgrain {

namespace {

using nlohmann::json;

void put(json& out, const std::string& name, const Estimate& e, double factor) {
  out[name] = number_or_null(factor * e.value);
  out[name + "_standard_error"] = number_or_null(factor * e.standard_error);
  out[name + "_interval"] = {number_or_null(factor * e.low), number_or_null(factor * e.high)};
}

json law_json(const ThresholdPowerLaw& law, double unit, const char* unit_name) {
  json out;
  put(out, "a", law.a, unit);
  put(out, "b", law.b, 1.0);
  put(out, "c", law.c, unit);
  put(out, "delta", law.delta, 1.0);
  out["unit"] = unit_name;
  return out;
}

/// kt in N/m and in N per degree of rotation of the soft particle; the angle it was measured over.
json tangential_json(const ThresholdPowerLaw& law, const SoftParticleSpec& spec, double angle_deg,
                     const char* meaning) {
  const double unit = spec.youngs_modulus * spec.shell_radius;
  const double per_degree = unit * std::numbers::pi * spec.shell_radius / 180.0;
  json out = law_json(law, unit, "N/m");
  put(out, "a_per_degree", law.a, per_degree);
  put(out, "c_per_degree", law.c, per_degree);
  out["unit_per_degree"] = "N/degree";
  out["angle_deg"] = angle_deg;
  out["meaning"] = meaning;
  return out;
}

json pair_json(const PairLaw& law, const SoftParticleSpec& spec) {
  // A tangential law that was asked for but could not be fitted has no exponent.
  const bool initial = has_numbers(law.status) && law.has_tangential_initial && law.tangential_initial.b.value > 0.0;
  const bool secant = has_numbers(law.status) && law.has_tangential_secant && law.tangential_secant.b.value > 0.0;
  const bool normal = has_numbers(law.status) && law.normal.b.value > 0.0;
  json out;
  out["status"] = to_string(law.status);
  out["reason"] = law.reason;
  out["normal"] =
      normal ? law_json(law.normal, spec.youngs_modulus * spec.shell_radius * spec.shell_radius, "N") : json(nullptr);
  out["tangential"] =
      initial ? tangential_json(law.tangential_initial, spec, law.initial_angle_deg, "initial slope") : json(nullptr);
  out["tangential_secant"] =
      secant ? tangential_json(law.tangential_secant, spec, law.secant_angle_deg, "secant") : json(nullptr);
  out["dimensionless"] = {{"normal", normal ? law_json(law.normal, 1.0, "E Rs^2") : json(nullptr)},
                          {"tangential", initial ? law_json(law.tangential_initial, 1.0, "E Rs") : json(nullptr)},
                          {"tangential_secant", secant ? law_json(law.tangential_secant, 1.0, "E Rs") : json(nullptr)}};
  out["delta_range"] = {law.delta_min, law.delta_max};
  out["max_overlap"] = law.max_overlap;
  out["packings"] = law.packings;
  out["points"] = law.points;
  out["chi2_per_dof"] = number_or_null(law.chi2_per_dof);
  out["quality"] = number_or_null(law.quality);
  return out;
}

json slide_json(const SlideLaw& slide) {
  json out;
  put(out, "kt_ratio", slide.kt_ratio, 1.0);
  put(out, "friction", slide.friction, 1.0);
  return out;
}

json crowd_json(const CrowdLaw& law) {
  json out = verdict_json(law);
  out["reason"] = law.reason;
  out["partners"] = json::array();
  for (const CrowdParameterName& p : kCrowdParameters) put(out, p.key, law.*p.estimate, 1.0);
  for (const PartnerRow& row : law.partners) {
    json one{
        {"kind", to_string(row.kind)}, {"ratio", row.ratio}, {"overlap_max", row.overlap_max}, {"error", row.error}};
    put(one, "weight", row.weight, 1.0);
    put(one, "exponent", row.exponent, 1.0);
    out["partners"].push_back(std::move(one));
  }
  return out;
}

}  // namespace

json verdict_json(const CrowdLaw& law) {
  return {{"form", to_string(law.form)},
          {"status", to_string(law.status)},
          {"error_fitted", number_or_null(law.error_fitted)},
          {"error_held_out", number_or_null(law.error_held_out)},
          {"error_cross", number_or_null(law.error_cross)}};
}

json verdict_json(const LawTableEntry& e) {
  return {{"solid_fraction", e.solid_fraction}, {"packings", e.packings},
          {"best", to_string(e.best)},          {"volume_max", e.volume_max},
          {"overlap_max", e.overlap_max},       {"grain_overlap_max", e.grain_overlap_max}};
}

json law_table_json(const LawTable& table) {
  json out{{"entries", json::array()}};
  for (const LawTableEntry& e : table.entries) {
    json one = verdict_json(e);
    one["solid_fraction_error"] = e.solid_fraction_error;
    one["main"] = &e == &main_entry(table);
    one["relaxation"] = e.relaxation;
    one["beyond"] = to_string(e.beyond);
    put(one, "retreat", e.retreat, 1.0);
    one["slides"] = {
        {"plane", slide_json(e.slide_plane)}, {"solid", slide_json(e.slide_solid)}, {"soft", slide_json(e.slide_soft)}};
    one["laws"] = json::array();
    for (const CrowdLaw& law : e.laws) one["laws"].push_back(crowd_json(law));
    out["entries"].push_back(std::move(one));
  }
  return out;
}

json laws_json(const LawCard& card) {
  json out = json::object();
  for (const PairLaw& law : card.pairs) out[to_string(law.kind)] = pair_json(law, card.spec);
  return out;
}

}  // namespace softgrain
