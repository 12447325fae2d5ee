// SPDX-License-Identifier: BSD-3-Clause
#include "macrosim/lammps/words.h"

#include <charconv>
#include <cmath>

#include "common/core/error.h"
#include "error.h"
#include "macrosim/lammps/law_source.h"
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
    } else {
      error->all(FLERR, "softgrain: '" + key + " " + value +
                            "': a card knows modulus E, friction MU, kt initial|secant, damping Z, beyond "
                            "error|clamp|extrapolate");
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

}  // namespace softgrain::lammps
