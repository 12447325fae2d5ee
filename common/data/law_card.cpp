#include "common/data/law_card.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/data/law_card_format.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"

namespace softgrain {

double ThresholdPowerLaw::value(double overlap_ratio) const {
  if (overlap_ratio < delta.value) return 0.0;
  return a.value * std::pow(overlap_ratio, b.value) + c.value;
}

double ThresholdPowerLaw::derivative(double overlap_ratio) const {
  if (overlap_ratio < delta.value) return 0.0;
  return a.value * b.value * std::pow(overlap_ratio, b.value - 1.0);
}

const PairLaw* LawCard::find(PairKind kind) const {
  for (const PairLaw& pair : pairs)
    if (pair.kind == kind) return &pair;
  return nullptr;
}

double assumed_kt_ratio(const LawCard& card, const PairLaw& law) {
  constexpr double kUnknown = 0.3;  // as scenes take nu of grains that nobody named
  if (is_known(law.kt_ratio)) return law.kt_ratio;
  return mindlin_ratio(is_known(card.spec.poisson_ratio) ? card.spec.poisson_ratio : kUnknown);
}

bool has_frozen_kt(const LawCard& card) {
  return !card.from_experiment() && card.turn == TurnProtocol::frozen &&
         std::any_of(card.pairs.begin(), card.pairs.end(), has_tangential);
}

std::string measured_text(const LawCard& card) {
  if (card.from_experiment()) return "from an experiment";
  const bool turned = std::any_of(card.pairs.begin(), card.pairs.end(), has_tangential);
  return "measured with the " + card.relaxation + " relaxation" + (turned ? ", kt by a " + to_string(card.turn) : "");
}

std::string table_path(const std::string& toml_path) {
  return std::filesystem::path(toml_path).replace_extension(".h5").string();
}

void save_card(const LawCard& card, const std::string& toml_path, const Provenance& provenance) {
  const std::string id = short_hash(card_text(card, provenance, ""));
  // The table first: a card on disk then always has its own table beside it.
  write_table(card, table_path(toml_path), provenance, id);
  write_text_atomic(toml_path, card_text(card, provenance, id));
}

LawCard load_card(const std::string& toml_path) { return load_card(Scene::load(toml_path)); }

LawCard load_card(const Scene& file) {
  LawCard card = read_card_text(file);
  const std::string table = table_path(file.path());
  if (std::filesystem::exists(table)) read_table(card, table);
  return card;
}

}  // namespace softgrain
