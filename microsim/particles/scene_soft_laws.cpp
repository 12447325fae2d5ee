#include "microsim/particles/scene_soft_laws.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <sstream>

#include "common/contact/law_set.h"
#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/data/card_text.h"
#include "common/data/law_card.h"
#include "common/data/law_words.h"
#include "common/data/multi_contact_law.h"
#include "common/io/key_record.h"
#include "common/io/text_file.h"
#include "microsim/particles/scene_contacts.h"

namespace softgrain {

namespace {

const Key kPairKindKey{"kind", "`law-card`: what meets; `\"soft-wall\"` with a law table only"};

/// Young's modulus that the law is scaled with.
double read_modulus(const SceneTable& t) {
  return t.number({"E", "`law-card`: Young's modulus that scales the law"}, Unit::pressure, Range::positive());
}

/// What a scene says of a contact that a law card gives the law for.
struct CardChoices {
  double modulus = 0.0;
  double friction = 0.0;
  double damping = 0.0;
  bool secant = false;
  std::optional<Extrapolation> beyond{};
  bool unloading = true;
};

bool read_unloading(const SceneTable& t) {
  return t.flag({"unloading", "use the measured unloading branch", "true for a law card that has one, else false"},
                false);
}

CardChoices read_card_choices(const SceneTable& t) {
  CardChoices c;
  c.modulus = read_modulus(t);
  c.friction = t.number("mu", Unit::none, Range::friction());
  c.damping = t.number({"damping", "law card: damping as a fraction of critical"}, Unit::none, Range::closed(0.0, 1.0));
  c.secant = t.choice<TangentialSlope>({"kt", "law card: slope that gives the tangential stiffness"}) ==
             TangentialSlope::secant;
  c.beyond = read_beyond(t);
  const bool said = t.has("unloading");
  c.unloading = read_unloading(t) || !said;
  return c;
}

CardLaw card_law(const SceneTable& t, const LawCard& card, PairKind kind) {
  const CardChoices c = read_card_choices(t);
  if (const PairLaw* law = card.find(kind); law != nullptr && !law->unloading && t.has("unloading") && c.unloading)
    t.throw_error("unloading", "unloading was not measured for this law card");
  try {
    return make_card_law(card, kind, c.modulus, c.friction, c.damping, c.secant, c.beyond, c.unloading);
  } catch (const Error& e) {
    t.throw_error("file", e.what());
  }
}

double read_solid_fraction(const SceneTable& t) {
  return t.number(
      {"solid_fraction", "law table: solid fraction of the grains inside a soft particle; it selects the law",
       "that of a table with one entry"},
      Unit::none, Range{0.0, 1.0, true, false});
}

LawTableEntry read_entry(const SceneTable& t, const LawTable& table, std::string& remark) {
  const auto range = t.choice<RangePolicy>("range", RangePolicy::reject);
  if (!t.has("solid_fraction")) {
    if (table.entries.size() == 1) return table.entries.front();
    std::ostringstream text;
    text << "the table has laws of " << table.entries.size() << " solid fractions, "
         << table.entries.front().solid_fraction << " to " << table.entries.back().solid_fraction
         << ": say which by solid_fraction, that of the grains inside a soft particle";
    t.throw_error("file", text.str());
  }
  const double fraction = read_solid_fraction(t);
  try {
    return entry_at(table, fraction, range, remark, kReachOfNumbers);
  } catch (const Error& e) {
    t.throw_error("solid_fraction", e.what());
  }
}

/// `best`: the form that the table names so.
MultiContactChoices read_choices(const SceneTable& t, LawForm best) {
  MultiContactChoices choices;
  choices.form = parse_enum<LawForm>(t.choice({"form",
                                               "law table: how the contacts of a particle influence each other; "
                                               "`\"best\"`: form that the table names as best"},
                                              {"pair", "isotropic", "directional", "best"}, "best"))
                     .value_or(best);
  choices.modulus = read_modulus(t);
  if (t.has("mu")) choices.friction = t.number("mu", Unit::none, Range::friction());
  choices.unloading = read_unloading(t);
  choices.rolling = t.flag({"rolling", "law table: use the rolling resistance, if measured"}, true);
  choices.beyond = read_beyond(t);
  return choices;
}

/// All that decides on the sums of a soft particle, friction left out: that may differ from contact to contact.
std::string choice_text(const std::string& path, const LawTableEntry& entry, const MultiContactChoices& c) {
  std::ostringstream text;
  text.precision(17);
  text << path << ", form " << to_string(c.form) << ", E = " << c.modulus << " Pa, solid fraction "
       << entry.solid_fraction << (c.unloading ? ", with" : ", without") << " unloading, beyond "
       << to_string(c.beyond.value_or(entry.beyond));
  return text.str();
}

}  // namespace

void SoftLawReader::read(const SceneTable& t, const PairOfMaterials& pair) {
  t.refuse({"unloading_ratio"},
           "goes with macro scenes, whose increments come to rest: particles that move have no largest volume at rest");
  const std::string path = scene_.resolve(t.filled_text({"file", "`law-card`: law card or law table"}));
  if (KeyRecord::current() != nullptr && !std::filesystem::exists(path)) ask_for_all(t, pair);
  out_.files += read_text(path);
  if (Scene::load(path).root().has("entry"))
    read_table(t, pair, path);
  else
    read_card(t, pair, path);
}

void SoftLawReader::ask_for_all(const SceneTable& t, const PairOfMaterials& pair) const {
  const std::string kind = t.choice(kPairKindKey, {"soft-solid", "soft-soft", "soft-wall"});
  (void)read_card_choices(t);
  (void)t.choice<RangePolicy>("range", RangePolicy::reject);
  if (t.has("solid_fraction")) (void)read_solid_fraction(t);
  (void)read_choices(t, LawForm::pair);
  if (kind != "soft-soft") (void)soft_of(t, pair);
}

std::int32_t SoftLawReader::soft_of(const SceneTable& t, const PairOfMaterials& pair) const {
  if (pair.first == pair.second) t.throw_error("pair", "a soft-solid contact needs two different materials");
  const std::int32_t soft = material_index(
      materials_, t, {"which_soft", "`law-card` of kind `soft-solid` or `soft-wall`: the soft material of the pair"});
  if (soft != pair.first && soft != pair.second) t.throw_error("which_soft", "must be one of the pair");
  return soft;
}

void SoftLawReader::read_card(const SceneTable& t, const PairOfMaterials& pair, const std::string& path) {
  for (const char* key : {"form", "solid_fraction", "range", "rolling"})
    if (t.has(key))
      t.throw_error(key, "goes with a law table; " + path + " is a law card, which holds the pair law alone");
  const auto kind = t.choice<PairKind>(kPairKindKey);
  const LawCard card = load_card(path);
  if (const std::string of_kt = kt_remark(card); !of_kt.empty())
    if (const std::string remark = path + ": " + of_kt;
        std::find(out_.remarks.begin(), out_.remarks.end(), remark) == out_.remarks.end())
      out_.remarks.push_back(remark);
  if (kind == PairKind::soft_soft) {
    out_.laws.set(pair.first, pair.second, any_law(card_law(t, card, PairKind::soft_soft)));
    return;
  }
  const AnyLaw law = any_law(card_law(t, card, PairKind::soft_solid));  // its body i is the soft one
  const std::int32_t soft = soft_of(t, pair);
  const std::int32_t solid = pair.first + pair.second - soft;
  out_.laws.set(soft, solid, law, true);
  out_.laws.set(solid, soft, mirrored(law), true);
}

void SoftLawReader::read_table(const SceneTable& t, const PairOfMaterials& pair, const std::string& path) {
  for (const char* key : {"damping", "kt"})
    if (t.has(key))
      t.throw_error(key, "goes with a law card; " + path + " is a law table, whose laws have no dashpots and one kt");
  const LawTable table = load_law_table(path);
  std::string remark;
  const LawTableEntry entry = read_entry(t, table, remark);
  const MultiContactChoices choices = read_choices(t, entry.best);
  if (!remark.empty()) out_.remarks.push_back(t.where("solid_fraction") + ": " + remark);
  MultiContactLaws laws;
  try {
    laws = make_multi_contact_laws(entry, choices);
  } catch (const Error& e) {
    t.throw_error("file", e.what());
  }
  const std::string choice = choice_text(path, entry, choices);
  const std::string kind = t.choice(kPairKindKey, {"soft-solid", "soft-soft", "soft-wall"});
  if (kind == "soft-soft") {
    agree(t, pair.first, choice);
    agree(t, pair.second, choice);
    out_.laws.set(pair.first, pair.second, laws.soft_soft);
    out_.scopes.push_back(LawScope::grains);
    return;
  }
  const std::int32_t soft = soft_of(t, pair);
  const std::int32_t solid = pair.first + pair.second - soft;
  agree(t, soft, choice);
  const AnyLaw& law = kind == "soft-wall" ? laws.soft_plane : laws.soft_solid;
  out_.laws.set(soft, solid, law, true);
  out_.laws.set(solid, soft, mirrored(law), true);
  out_.scopes.resize(static_cast<std::size_t>(out_.laws.size()),
                     kind == "soft-wall" ? LawScope::walls : LawScope::grains);
}

void SoftLawReader::agree(const SceneTable& t, std::int32_t soft, const std::string& choice) {
  const auto [at, fresh] = choices_.try_emplace(soft, Choice{choice, t.where("file")});
  if (fresh || at->second.text == choice) return;
  t.throw_error("file", "the contacts of a soft particle add up, so that all of '" +
                            materials_[static_cast<std::size_t>(soft)].name + "' need one law; here: " + choice +
                            "; before: " + at->second.text + " (" + at->second.where + ")");
}

void SoftLawReader::require_whole() const {
  for (const auto& [soft, choice] : choices_)
    for (std::int32_t m = 0; m < out_.laws.materials(); ++m) {
      const std::int32_t index = out_.laws.index(soft, m);
      if (index == LawSet::kNoContact || traits_of(out_.laws.law(index)).is_multi_contact) continue;
      throw InputError(choice.where + ": the law table of '" + materials_[static_cast<std::size_t>(soft)].name +
                       "' adds up all contacts of a soft particle, and cannot be combined with " +
                       out_.description[static_cast<std::size_t>(index)]);
    }
}

}  // namespace softgrain
