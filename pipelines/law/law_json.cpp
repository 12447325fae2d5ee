#include "pipelines/law/law_json.h"

#include <numbers>

namespace softgrain {

namespace {

using nlohmann::json;

void put(json& out, const std::string& name, const Estimate& e) {
  estimate_fields([&](const std::string& key, const auto& value, const auto&...) { out[key] = json_of(value); }, name,
                  e);
}

Estimate scaled(const Estimate& e, double factor) {
  return {factor * e.value, factor * e.standard_error, factor * e.low, factor * e.high};
}

LawNumbers numbers_of(const ThresholdPowerLaw& law, double unit, const char* unit_name) {
  return {scaled(law.a, unit), law.b, scaled(law.c, unit), law.delta, unit_name, {}};
}

/// kt in N/m and in N per degree of rotation of the soft particle; the angle it was measured over.
LawNumbers stiffness_of(const ThresholdPowerLaw& law, const SoftParticleSpec& spec, double angle_deg,
                        const char* meaning) {
  const double unit = spec.youngs_modulus * spec.shell_radius;
  const double per_degree = unit * std::numbers::pi * spec.shell_radius / 180.0;
  LawNumbers out = numbers_of(law, unit, "N/m");
  out.per_degree = {scaled(law.a, per_degree), scaled(law.c, per_degree), angle_deg, meaning};
  return out;
}

PairLawSummary summary_of(const PairLaw& law, const SoftParticleSpec& spec) {
  PairLawSummary out{
      law.status, law.reason,       {},         {}, {law.delta_min, law.delta_max}, law.max_overlap, law.packings,
      law.points, law.chi2_per_dof, law.quality};
  if (!has_numbers(law.status)) return out;
  if (const auto& u = law.unloading) {
    out.unloading = {u->residual, u->exponent, u->samples, u->points};
    if (u->deepest > 0.0) out.unloading->deepest = u->deepest;
  }
  if (law.normal.b.value > 0.0) {
    out.parts.normal = numbers_of(law.normal, spec.youngs_modulus * spec.shell_radius * spec.shell_radius, "N");
    out.dimensionless.normal = numbers_of(law.normal, 1.0, "E Rs^2");
  }
  // A tangential law that was asked for but could not be fitted has no exponent.
  if (law.has_tangential_initial && law.tangential_initial.b.value > 0.0) {
    out.parts.tangential = stiffness_of(law.tangential_initial, spec, law.initial_angle_deg, "initial slope");
    out.dimensionless.tangential = numbers_of(law.tangential_initial, 1.0, "E Rs");
  }
  if (law.has_tangential_secant && law.tangential_secant.b.value > 0.0) {
    out.parts.tangential_secant = stiffness_of(law.tangential_secant, spec, law.secant_angle_deg, "secant");
    out.dimensionless.tangential_secant = numbers_of(law.tangential_secant, 1.0, "E Rs");
  }
  return out;
}

json slide_json(const SlideLaw& slide) {
  json out;
  put(out, "kt_ratio", slide.kt_ratio);
  put(out, "friction", slide.friction);
  if (slide.rolls) {
    put(out, "rolling", slide.rolling);
    put(out, "rolling_friction", slide.rolling_friction);
  }
  if (slide.has_unloading) put(out, "unloading", slide.unloading);
  return out;
}

json multi_contact_json(const MultiContactLaw& law) {
  json out = verdict_json(law);
  out["reason"] = law.reason;
  out["partners"] = json::array();
  for (const MultiContactParameterName& p : kMultiContactParameters) put(out, p.key, law.*p.estimate);
  for (const PartnerRow& row : law.partners) {
    json one{
        {"kind", to_string(row.kind)}, {"ratio", row.ratio}, {"overlap_max", row.overlap_max}, {"error", row.error}};
    put(one, "weight", row.weight);
    put(one, "exponent", row.exponent);
    out["partners"].push_back(std::move(one));
  }
  return out;
}

}  // namespace

json verdict_json(const MultiContactLaw& law) {
  json out;
  verdict_fields([&out](const char* key, const auto& value, const auto&...) { out[key] = json_of(value); }, law);
  return out;
}

json verdict_json(const LawTableEntry& entry) {
  json out;
  verdict_fields([&out](const char* key, const auto& value, const auto&...) { out[key] = json_of(value); }, entry);
  return out;
}

json law_json(const LawTable& table) {
  json out{{"entries", json::array()}};
  for (const LawTableEntry& e : table.entries) {
    json one = verdict_json(e);
    one["solid_fraction_error"] = e.solid_fraction_error;
    if (e.grains > 0.0) one["grains"] = e.grains;
    one["main"] = &e == &main_entry(table);
    one["relaxation"] = e.relaxation;
    one["beyond"] = to_string(e.beyond);
    put(one, "unloading", e.unloading);
    one["slides"] = {
        {"plane", slide_json(e.slide_plane)}, {"solid", slide_json(e.slide_solid)}, {"soft", slide_json(e.slide_soft)}};
    one["laws"] = json::array();
    if (e.prior) one["prior"] = json_of(*e.prior);
    for (const MultiContactLaw& law : e.laws) one["laws"].push_back(multi_contact_json(law));
    out["entries"].push_back(std::move(one));
  }
  return out;
}

std::map<std::string, PairLawSummary> summary_of(const LawCard& card) {
  std::map<std::string, PairLawSummary> out;
  for (const PairLaw& law : card.pairs) out[to_string(law.kind)] = summary_of(law, card.spec);
  return out;
}

json law_json(const LawCard& card) { return json_of(summary_of(card)); }

}  // namespace softgrain
