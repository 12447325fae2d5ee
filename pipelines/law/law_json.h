// Fitted laws as JSON, for summaries and for softgrain law: in newtons and metres for the soft particle that was
// measured, and dimensionless.
#pragma once

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/core/limits.h"
#include "common/data/cell_card.h"
#include "common/data/law_card.h"
#include "common/data/multi_contact_law.h"
#include "common/io/json_record.h"

namespace softgrain {

/// Every estimate x comes with x_standard_error and x_interval = [low, high] (95 %); null: not known.
void estimate_fields(auto&& visit, const std::string& name, auto& e, const Means& means = {"", "1"}) {
  visit(name, e.value, means);
  visit(name + "_standard_error", e.standard_error, Means{"its standard error", means.unit});
  range_field(visit, name + "_interval", e.low, e.high, Means{"its 95 % interval", means.unit});
}

/// F(D) = a D^b + c above delta, D = hn/Rs, with a and c in `unit`. Stiffnesses also per degree of rotation (times
/// pi Rs/180).
struct LawNumbers {
  static constexpr Estimate kUnknown{kNaN, kNaN, kNaN, kNaN};
  Estimate a = kUnknown;
  Estimate b = kUnknown;
  Estimate c = kUnknown;
  Estimate delta = kUnknown;
  std::string unit;
  struct PerDegree {
    Estimate a;
    Estimate c;
    double angle_deg = 0.0;  ///< angle over which it was measured
    std::string meaning;     ///< initial slope or secant
  };
  std::optional<PerDegree> per_degree;
};

void fields(auto&& visit, Of<LawNumbers> auto& s) {
  estimate_fields(visit, "a", s.a);
  estimate_fields(visit, "b", s.b);
  estimate_fields(visit, "c", s.c);
  estimate_fields(visit, "delta", s.delta);
  visit("unit", s.unit);
  if (!s.per_degree) return;
  estimate_fields(visit, "a_per_degree", s.per_degree->a);
  estimate_fields(visit, "c_per_degree", s.per_degree->c);
  visit("unit_per_degree", std::string("N/degree"));
  visit("angle_deg", s.per_degree->angle_deg);
  visit("meaning", s.per_degree->meaning);
}

/// The laws of one kind of contact; empty: not fitted. "tangential" is the initial slope.
struct LawParts {
  std::optional<LawNumbers> normal;
  std::optional<LawNumbers> tangential;
  std::optional<LawNumbers> tangential_secant;
};

void fields(auto&& visit, Of<LawParts> auto& s) {
  visit("normal", s.normal);
  visit("tangential", s.tangential);
  visit("tangential_secant", s.tangential_secant);
}

struct PairLawSummary {
  LawStatus status = LawStatus::not_run;
  std::string reason;
  LawParts parts;  ///< laws in N (times E Rs^2) and N/m (times E Rs)
  LawParts dimensionless;
  std::array<double, 2> delta_range{};
  double max_overlap = 0.0;
  int packings = 0;
  int points = 0;
  double chi2_per_dof = 0.0;
  double quality = 0.0;
  struct Unloading {
    Estimate residual;
    Estimate exponent;
    int samples = 0;
    int points = 0;
    std::optional<double> deepest{};  ///< mean Delta_max; empty: not said
  };
  std::optional<Unloading> unloading{};  ///< empty: not measured
};

void fields(auto&& visit, Of<PairLawSummary::Unloading> auto& s) {
  estimate_fields(visit, "residual", s.residual);
  estimate_fields(visit, "exponent", s.exponent);
  visit("samples", s.samples);
  visit("points", s.points);
  visit("deepest", s.deepest, kLeftOut);
}

void fields(auto&& visit, Of<PairLawSummary> auto& s) {
  visit("status", s.status);
  visit("reason", s.reason);
  fields(visit, s.parts);
  visit("dimensionless", s.dimensionless);
  visit("delta_range", s.delta_range);
  visit("max_overlap", s.max_overlap);
  visit("packings", s.packings);
  visit("points", s.points);
  visit("chi2_per_dof", s.chi2_per_dof);
  visit("quality", s.quality);
  visit("unloading", s.unloading, kLeftOut);
}

/// Laws of a card, by the kind of contact.
std::map<std::string, PairLawSummary> summary_of(const LawCard& card);
nlohmann::json law_json(const LawCard& card);

/// { "entries": [ { "solid_fraction", "packings", "best", "volume_max", "overlap_max", "beyond", "unloading", "slides",
/// "laws": [ { "form", "status", "a", ..., "partners", "error_fitted", ... } ] } ] }, dimensionless; estimates as in
/// estimate_fields().
nlohmann::json law_json(const LawTable& table);

/// Numbers with { "value", "standard_error", "interval" }, ranges, and what they were measured on; dimensionless.
nlohmann::json law_json(const CellCard& card);

/// What every list of laws says of a law: form, status, errors.
nlohmann::json verdict_json(const MultiContactLaw& law);
/// What every list of laws says of an entry: which packings, the best form, up to where it was measured.
nlohmann::json verdict_json(const LawTableEntry& entry);

}  // namespace softgrain
