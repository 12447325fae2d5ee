// Reads the words of a script, and the laws that they name.
// SPDX-License-Identifier: BSD-3-Clause
#include "macrosim/lammps/words.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <type_traits>

#include "common/contact/law_set.h"
#include "common/contact/soft_contact.h"
#include "common/core/error.h"
#include "common/io/toml.h"
#include "error.h"
#include "pointers.h"

namespace softgrain::lammps {

namespace {

int type_number(const std::string& word, const std::string& all, int types, LAMMPS_NS::Error* error) {
  int out = 0;
  const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), out);
  if (problem != std::errc() || end != word.data() + word.size() || out < 1 || out > types)
    error->all(FLERR, "softgrain: '" + all + "' is no range of atom types within 1.." + std::to_string(types));
  return out;
}

AnyLaw read_card(char** words, int count, MPI_Comm world, LAMMPS_NS::Error* error) {
  if (count < 2) error->all(FLERR, std::string("softgrain: card FILE KIND modulus E friction MU ..."));
  CardChoices choices;
  bool friction = false;
  for (int k = 2; k < count; k += 2) {
    const std::string key = words[k];
    if (k + 1 >= count) error->all(FLERR, "softgrain: '" + key + "' of a card needs a value");
    const std::string value = words[k + 1];
    if (key == "modulus") {
      choices.modulus = number(value, key, error);
    } else if (key == "friction") {
      choices.friction = number(value, key, error);
      friction = true;
    } else if (key == "damping") {
      choices.damping = number(value, key, error);
    } else if (key == "beyond") {
      choices.beyond = value;
    } else if (key == "kt" && (value == "initial" || value == "secant")) {
      choices.secant = value == "secant";
      choices.slope_said = true;
    } else if (key == "unloading" && (value == "yes" || value == "no")) {
      choices.unloading = value == "yes";
    } else {
      error->all(FLERR, "softgrain: '" + key + " " + value +
                            "': a card knows modulus E, friction MU, kt initial|secant, damping Z, beyond "
                            "error|clamp|extrapolate, unloading yes|no");
    }
  }
  if (!(choices.modulus > 0.0) || !friction || choices.friction < 0.0 || choices.damping < 0.0)
    error->all(FLERR, std::string("softgrain: a card needs modulus above 0 and friction (not negative)"));
  return law_of_card(words[0], words[1], choices, world);
}

}  // namespace

std::pair<int, int> type_range(const std::string& word, int types, LAMMPS_NS::Error* error) {
  const auto star = word.find('*');
  if (star == std::string::npos) {
    const int type = type_number(word, word, types, error);
    return {type, type};
  }
  const std::string low = word.substr(0, star);
  const std::string high = word.substr(star + 1);
  const std::pair<int, int> out{low.empty() ? 1 : type_number(low, word, types, error),
                                high.empty() ? types : type_number(high, word, types, error)};
  if (out.first > out.second) error->all(FLERR, "softgrain: '" + word + "' is an empty range of atom types");
  return out;
}

double number(const std::string& word, const std::string& what, LAMMPS_NS::Error* error) {
  double out = 0.0;
  const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), out);
  if (problem != std::errc() || end != word.data() + word.size() || !std::isfinite(out))
    error->all(FLERR, "softgrain: " + what + " '" + word + "' is no number");
  return out;
}

AnyLaw read_law_words(char** words, int count, MPI_Comm world, LAMMPS_NS::Error* error) {
  try {
    if (std::string(words[0]) == "card") return read_card(words + 1, count - 1, world, error);
    if (count != 2) error->all(FLERR, std::string("softgrain: a law is FILE NAME, or card FILE KIND ..."));
    return law_of_file(words[0], words[1], world);
  } catch (const softgrain::Error& e) {
    error->all(FLERR, std::string(e.what()));
  }
}

void check_dimension(const AnyLaw& law, int dimension, LAMMPS_NS::Error* error) {
  const bool serves = std::visit(
      [&]<class Law>(const Law&) { return dimension == 2 ? law_serves<Law, 2>() : law_serves<Law, 3>(); }, law);
  if (!serves)
    error->all(FLERR, "softgrain: this law is for " + std::string(dimension == 2 ? "three" : "two") +
                          " dimensions, the script has " + std::to_string(dimension));
}

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

/// The stiffness that was asked for. Where the script does not say which: the initial one, else the one that was
/// fitted, else none.
PowerTerm tangential_term(const toml::table& pair, const CardChoices& choices, const std::string& where) {
  const bool secant = choices.secant;
  const bool has_initial = pair.at_path("tangential_initial.fitted").value_or(false);
  const bool has_secant = pair.at_path("tangential_secant.fitted").value_or(false);
  if (choices.slope_said && !(secant ? has_secant : has_initial))
    throw InputError(where + ": kt " + (secant ? "secant" : "initial") + ": the card has " +
                     (has_secant    ? "the secant alone"
                      : has_initial ? "the initial slope alone"
                                    : "no tangential stiffness: leave kt out"));
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
  law.tangential = tangential_term(pair, choices, where);
  law.delta = number(pair, "normal.delta.value", where);
  law.modulus = choices.modulus;
  law.friction = choices.friction;
  law.damping = choices.damping;
  law.range = range_of(pair, choices.beyond, where);
  law.partner_is_soft = kind == "soft-soft";
  const bool unloads = pair.at_path("unloading").as_table() != nullptr;
  if (choices.unloading.value_or(false) && !unloads)
    throw InputError(where + ": unloading yes: the card has no unloading branch: leave it out");
  if (!unloads || !choices.unloading.value_or(true)) return law;
  const UnloadingBranch branch{number(pair, "unloading.residual.value", where),
                               number(pair, "unloading.exponent.value", where)};
  constexpr double kRounding = 1e-9;
  if (!(branch.residual >= 0.0 && branch.residual <= kLargestResidual) ||
      branch.exponent < least_unloading_exponent(branch.residual, law.normal.b) * (1.0 - kRounding))
    throw InputError(where + ": unloading needs a residual from 0 to " +
                     (std::ostringstream() << kLargestResidual).str() +
                     " and an exponent with which no cycle gains energy");
  return SoftUnloading{
      law, {branch.residual, std::max(branch.exponent, least_unloading_exponent(branch.residual, law.normal.b))}};
}

}  // namespace softgrain::lammps
