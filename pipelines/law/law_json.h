// Fitted laws as JSON, for summaries and for softgrain law: in newtons and metres for the soft particle that was
// measured, and dimensionless.
#pragma once

#include <nlohmann/json.hpp>

#include "common/data/crowd_law.h"
#include "common/data/law_card.h"

namespace softgrain {

/// { "soft-solid": { "status", "reason", "normal": {...}, "tangential": {...}, "tangential_secant": {...},
/// "dimensionless": {...},
///   "delta_range", "packings", "points", "max_overlap", "chi2_per_dof", "quality" }, "soft-soft": ... }
/// Laws read F(D) = a D^b + c above delta, D = hn/Rs. Normal: a, c in N (times E Rs^2). Tangential: kt with a, c in N/m
/// (times E Rs), and a_per_degree, c_per_degree in N per degree of rotation (times pi Rs/180); "tangential" is the
/// initial slope. Every parameter x comes with x_standard_error and x_interval = [low, high] (95 %, bootstrap over
/// packings); null: not known. A law that was not fitted is null.
nlohmann::json laws_json(const LawCard& card);

/// { "entries": [ { "solid_fraction", "packings", "best", "volume_max", "overlap_max", "beyond", "retreat", "slides",
/// "laws": [ { "form", "status", "a", ..., "partners", "error_fitted", ... } ] } ] }, dimensionless; estimates as in
/// laws_json().
nlohmann::json law_table_json(const LawTable& table);

/// What every list of laws says of one: form, status, errors.
nlohmann::json verdict_json(const CrowdLaw& law);
/// And of an entry: which packings, the best form, up to where it was measured.
nlohmann::json verdict_json(const LawTableEntry& entry);

}  // namespace softgrain
