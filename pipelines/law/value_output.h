// Values of laws as a terminal table, CSV and JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipelines/law/law_values.h"

namespace softgrain::law {

/// What the numbers are given in: over E R^2 and E R, or newtons and newtons per metre for this E and R.
struct ValueUnits {
  bool si = false;
  double modulus = 1.0;  ///< E [Pa]
  double radius = 1.0;   ///< R that Delta refers to [m]

  [[nodiscard]] double force() const { return si ? modulus * radius * radius : 1.0; }
  [[nodiscard]] double stiffness() const { return si ? modulus * radius : 1.0; }
};

/// Values of one law and what to call it.
struct ValueTable {
  std::string law;  ///< "soft-solid", "cube of planes, directional law"
  LawStatus status = LawStatus::good;
  std::string remark;  ///< remark for human readers; may be empty
  Extrapolation beyond = Extrapolation::extrapolate;
  bool use_secant = false;  ///< whether the terminal shows the secant kt; it has room for one of the two
  std::vector<LawPoint> points;
};

/// Terminal table of at most 80 columns.
std::string values_text(const ValueTable& table, const ValueUnits& units);

/// One line per value with a header; empty cells where something is not known or refused.
std::string values_csv(const std::vector<ValueTable>& tables, const ValueUnits& units);

/// { "law", "status", "beyond", "remark", "values": [ { "delta", "where", "force", "force_interval", ... } ] }; null:
/// not known or refused.
nlohmann::json values_json(const ValueTable& table, const ValueUnits& units);

/// Names of the units, for headers: "E R^2" or "N".
std::string force_unit(const ValueUnits& units);
std::string stiffness_unit(const ValueUnits& units);

}  // namespace softgrain::law
