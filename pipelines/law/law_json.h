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
  estimate_fields(visit, "a", s.a, {"a of F(D) = a D^b + c", "as `unit` says"});
  estimate_fields(visit, "b", s.b, {"exponent b", "1"});
  estimate_fields(visit, "c", s.c, {"c of F(D) = a D^b + c", "as `unit` says"});
  estimate_fields(visit, "delta", s.delta, {"overlap D below which there is no force", "1"});
  visit("unit", s.unit, Means{"unit of a and c"});
  LawNumbers::PerDegree none;
  if (!s.per_degree && !Describes<decltype(visit)>) return;
  auto& degree = s.per_degree ? *s.per_degree : none;
  estimate_fields(visit, "a_per_degree", degree.a, {"a per degree of rotation", "N/degree"});
  estimate_fields(visit, "c_per_degree", degree.c, {"c per degree of rotation", "N/degree"});
  visit("unit_per_degree", std::string("N/degree"), Means{"unit per degree of rotation"});
  visit("angle_deg", degree.angle_deg, Means{"angle over which it was measured", "degree"});
  visit("meaning", degree.meaning, Means{"initial slope or secant"});
}

/// The laws of one kind of contact; empty: not fitted. "tangential" is the initial slope.
struct LawParts {
  std::optional<LawNumbers> normal;
  std::optional<LawNumbers> tangential;
  std::optional<LawNumbers> tangential_secant;
};

void fields(auto&& visit, Of<LawParts> auto& s) {
  visit("normal", s.normal, Means{"normal force F(D) = a D^b + c above delta, D = hn/Rs"});
  visit("tangential", s.tangential, Means{"tangential stiffness, initial slope"});
  visit("tangential_secant", s.tangential_secant, Means{"tangential stiffness, secant"});
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
  estimate_fields(visit, "residual", s.residual,
                  {"share of the depth below the threshold that stays after unloading", "1"});
  estimate_fields(visit, "exponent", s.exponent, {"exponent of the unloading branch", "1"});
  visit("samples", s.samples, Means{"number of samples", "1"});
  visit("points", s.points, Means{"number of points", "1"});
  visit("deepest", s.deepest, kLeftOut, Means{"mean of the deepest overlap Delta_max", "1"});
}

void fields(auto&& visit, Of<PairLawSummary> auto& s) {
  visit("status", s.status, Means{"whether the law is usable"});
  visit("reason", s.reason, Means{"why not"});
  fields(visit, s.parts);
  visit("dimensionless", s.dimensionless, Means{"the same laws, forces over E Rs^2 and stiffnesses over E Rs"});
  visit("delta_range", s.delta_range, Means{"range of Delta that was fitted", "1"});
  visit("max_overlap", s.max_overlap, Means{"largest grain overlap over the smaller radius in that range", "1"});
  visit("packings", s.packings, Means{"number of packings", "1"});
  visit("points", s.points, Means{"number of points", "1"});
  visit("chi2_per_dof", s.chi2_per_dof, Means{"chi^2 per degree of freedom", "1"});
  visit("quality", s.quality, Means{"probability of a larger chi^2", "1"});
  visit("unloading", s.unloading, kLeftOut, Means{"how the contact unloads; absent: not measured"});
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
void verdict_fields(auto&& visit, Of<MultiContactLaw> auto& law) {
  visit("form", law.form, Means{"form of the law"});
  visit("status", law.status, Means{"whether the law is usable"});
  visit("error_fitted", law.error_fitted, Means{"relative error of the forces that it was fitted to", "1"});
  visit("error_held_out", law.error_held_out, Means{"relative error of the forces that were held out", "1"});
  visit("error_cross", law.error_cross, Means{"relative error of forces in cross-validation", "1"});
}
/// What every list of laws says of an entry: which packings, the best form, up to where it was measured.
void verdict_fields(auto&& visit, Of<LawTableEntry> auto& e) {
  visit("solid_fraction", e.solid_fraction, Means{"solid fraction of the packings", "1"});
  visit("packings", e.packings, Means{"number of packings", "1"});
  visit("best", e.best, Means{"best form of law"});
  visit("volume_max", e.volume_max, Means{"largest equivalent volume S among the fitted states", "1"});
  visit("overlap_max", e.overlap_max, Means{"largest overlap h/Rs that was measured", "1"});
  visit("grain_overlap_max", e.grain_overlap_max, Means{"largest grain overlap over the smaller radius", "1"});
}
nlohmann::json verdict_json(const MultiContactLaw& law);
nlohmann::json verdict_json(const LawTableEntry& entry);

}  // namespace softgrain
