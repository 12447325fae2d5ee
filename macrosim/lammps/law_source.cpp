// SPDX-License-Identifier: BSD-3-Clause
#include "macrosim/lammps/law_source.h"

#include <cmath>
#include <fstream>
#include <sstream>
#include <type_traits>

#include "common/contact/law_file.h"
#include "common/contact/threshold_term.h"
#include "common/core/error.h"
#include "common/io/toml.h"

namespace softgrain::lammps {

namespace {

/// A number of a card, by its path ("normal.a.value").
double number(const toml::table& pair, const std::string& path, const std::string& where) {
  const auto value = pair.at_path(path).value<double>();
  if (!value || !std::isfinite(*value)) throw InputError(where + ": " + path + " must be a number");
  return *value;
}

PowerTerm term(const toml::table& pair, const std::string& part, const std::string& where) {
  const double a = number(pair, part + ".a.value", where);
  const double b = number(pair, part + ".b.value", where);
  const double delta = number(pair, part + ".delta.value", where);
  if (!(a > 0.0 && b > 0.0 && delta >= 0.0 && delta < 1.0))
    throw InputError(where + ": " + part + " needs a > 0, b > 0 and delta in [0, 1)");
  return threshold_term(a, b, delta);
}

/// The stiffness that was asked for, else the one that was fitted, else none.
PowerTerm tangential_term(const toml::table& pair, bool secant, const std::string& where) {
  const bool has_initial = pair.at_path("tangential_initial.fitted").value_or(false);
  const bool has_secant = pair.at_path("tangential_secant.fitted").value_or(false);
  if (has_secant && (secant || !has_initial)) return term(pair, "tangential_secant", where);
  return has_initial ? term(pair, "tangential_initial", where) : PowerTerm{};
}

LawRange range_of(const toml::table& pair, const std::string& beyond, const std::string& where) {
  LawRange range;
  const double end = number(pair, "validity.delta_max", where);
  if (!(end > 0.0)) return range;
  range.end = end;
  const std::string policy =
      beyond.empty() ? pair.at_path("validity.beyond").value_or(std::string("extrapolate")) : beyond;
  for (const Extrapolation b : {Extrapolation::error, Extrapolation::clamp, Extrapolation::extrapolate})
    if (policy == to_string(b)) {
      range.beyond = b;
      return range;
    }
  throw InputError(where + ": beyond must be error, clamp or extrapolate, not '" + policy + "'");
}

const toml::table& pair_of(const toml::table& card, const std::string& kind, const std::string& path) {
  if (const toml::array* pairs = card["pair"].as_array())
    for (const auto& node : *pairs)
      if (node.is_table() && node.at_path("kind").value_or(std::string()) == kind) return *node.as_table();
  throw InputError(path + ": no law card with a " + kind + " law");
}

}  // namespace

std::string broadcast_file(const std::string& path, MPI_Comm world) {
  int rank = 0;
  MPI_Comm_rank(world, &rank);
  std::string text;
  long long size = -1;
  if (rank == 0) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream content;
    if (file && content << file.rdbuf()) {
      text = content.str();
      size = static_cast<long long>(text.size());
    }
  }
  MPI_Bcast(&size, 1, MPI_LONG_LONG, 0, world);
  if (size < 0) throw IoError(path + ": cannot be read");
  if (size > 100000000) throw IoError(path + ": too large for contact laws");
  text.resize(static_cast<std::size_t>(size));
  MPI_Bcast(text.data(), static_cast<int>(size), MPI_CHAR, 0, world);
  return text;
}

AnyLaw law_of_file(const std::string& path, const std::string& name, MPI_Comm world) {
  std::string known;
  for (const auto& [found, law] : parse_laws(broadcast_file(path, world), path)) {
    if (found == name) return law;
    known += (known.empty() ? "" : ", ") + found;
  }
  throw InputError(path + ": no law '" + name + "'; there are: " + known);
}

AnyLaw law_of_card(const std::string& path, const std::string& kind, const CardChoices& choices, MPI_Comm world) {
  if (kind != "soft-solid" && kind != "soft-soft")
    throw InputError("kind '" + kind + "' of a law card: must be soft-solid or soft-soft");
  const toml::table card = parse_toml(broadcast_file(path, world), path);
  const toml::table& pair = pair_of(card, kind, path);
  const std::string where = path + ": " + kind + " law";
  const std::string status = pair["status"].value_or(std::string("missing"));
  if (status != "good" && status != "underdetermined")
    throw InputError(where + " is not usable: its status is \"" + status + "\"");
  SoftContact law;
  law.normal = term(pair, "normal", where);
  law.tangential = tangential_term(pair, choices.secant, where);
  law.delta = number(pair, "normal.delta.value", where);
  law.modulus = choices.modulus;
  law.friction = choices.friction;
  law.damping = choices.damping;
  law.range = range_of(pair, choices.beyond, where);
  law.partner_is_soft = kind == "soft-soft";
  return law;
}

}  // namespace softgrain::lammps
