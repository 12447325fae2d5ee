#include "pipelines/law/named_laws.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/contact/law_set.h"
#include "common/contact/make_laws.h"
#include "common/core/error.h"
#include "common/core/text.h"
#include "common/data/card_text.h"
#include "common/data/law_words.h"
#include "common/data/multi_contact_replicates.h"
#include "common/dynamics/force_pass.h"
#include "common/io/text_file.h"
#include "macrosim/curve_notes.h"
#include "pipelines/law/law_library_scene.h"

namespace softgrain {

namespace {

std::int32_t law_of(const System3& s, const ContactRecord<3>& c) {
  const auto& material = s.particles.material;
  return s.laws.index(material[static_cast<std::size_t>(c.i)], material[static_cast<std::size_t>(c.j)]);
}

/// What the multi-contact laws of a run meet at its end that was not measured: single overlaps beyond the end of the
/// table, ratios that no row covers.
class RangeCheck {
 public:
  RangeCheck(const LawTableEntry& entry, LawForm form) : entry_(entry), law_(*entry.find(form)) {}

  /// Contacts of partners whose size the table does not have.
  [[nodiscard]] std::string note(const System3& s) const {
    const Counts c = count(s);
    if (c.outside == 0) return "";
    return fmt::format("{} of {} soft contacts have a size ratio outside the table; its nearest row was used",
                       c.outside, c.all);
  }

  /// Contacts deeper than the row of the nearest ratio.
  [[nodiscard]] std::string warning(const System3& s) const {
    const Counts c = count(s);
    if (c.deep == 0) return "";
    return fmt::format(
        "{} of {} soft contacts are deeper at the end than the law was measured: strain less, or measure "
        "larger overlaps",
        c.deep, c.all);
  }

 private:
  struct Counts {
    std::size_t deep = 0;
    std::size_t outside = 0;
    std::size_t all = 0;
  };

  [[nodiscard]] Counts count(const System3& s) const {
    Counts out;
    for (const ContactRecord<3>& c : contact_records(s)) {
      if (!is_multi_contact_law(s.laws.law(law_of(s, c)))) continue;
      ++out.all;
      const auto& p = s.particles;
      const double ri = p.sphere[static_cast<std::size_t>(c.i)].r;
      const double rj = c.j < p.grains ? p.sphere[static_cast<std::size_t>(c.j)].r : 0.0;
      const bool i_soft = p.material[static_cast<std::size_t>(c.i)] == kSoftMaterial;
      const bool j_soft = c.j < p.grains && p.material[static_cast<std::size_t>(c.j)] == kSoftMaterial;
      if (rj == 0.0) {
        out.deep += c.overlap / ri > entry_.overlap_max ? 1 : 0;
        continue;
      }
      const PartnerKind kind = i_soft && j_soft ? PartnerKind::soft : PartnerKind::solid;
      const auto rows = law_.rows(kind);
      double ratio = i_soft ? rj / ri : ri / rj;
      if (i_soft && j_soft) ratio = std::max(ratio, 1.0 / ratio);
      const bool covered =
          !rows.empty() && ratio >= rows.front().ratio && (!j_soft || !i_soft || ratio <= rows.back().ratio);
      out.outside += covered ? 0 : 1;
      const double measured = measured_overlap(entry_, law_.form, kind, i_soft ? rj / ri : ri / rj);
      out.deep += !rows.empty() && c.overlap > measured * (i_soft ? ri : rj) ? 1 : 0;
    }
    return out;
  }

  static constexpr std::int32_t kSoftMaterial = 1;  ///< number of the soft material in make_law_system()
  static bool is_multi_contact_law(const AnyLaw& law) {
    return std::visit([]<class Law>(const Law&) { return law_serves<Law, 3>() && !law_serves<Law, 2>(); }, law);
  }

  LawTableEntry entry_;
  MultiContactLaw law_;
};

/// A short name of all numbers of a law, so that a run that goes on does not mistake another law for this one.
std::string tag_of(const LawTableEntry& entry, const LawSources& sources, LawForm form) {
  const std::string memory =
      sources.unloading_ratio > 1.0 ? fmt::format("unloading ratio {:a} ", sources.unloading_ratio) : "";
  return short_hash(fmt::format("{}{}{} {} {} {} {:a}", memory, sources.rolling ? "" : "rolls freely ",
                                sources.friction.value_or(-1.0), sources.unloading, numbers_of(entry, form),
                                to_string(sources.beyond.value_or(entry.beyond)), entry.volume_max));
}

/// E scales; nu and mu do not.
void require_same_material(const LawTableEntry& entry, const MacroSpec& spec) {
  const SoftParticleSpec& measured = entry.spec;
  if (measured.poisson_ratio != spec.poisson_ratio || measured.friction != spec.friction)
    throw InputError(
        fmt::format("law table: it was measured with nu = {}, mu = {} and serves no grains of nu = {}, mu = {}: "
                    "measure a table for "
                    "them",
                    measured.poisson_ratio, measured.friction, spec.poisson_ratio, spec.friction));
}

/// Hash of everything that forces depend on, however it came about. Names count as earlier versions wrote them, so that
/// the hash of a law does not change with the name of its form.
std::string hash_of(const SoftLaws& l) {
  std::string text = laws_text({{"soft-solid", l.soft_solid},
                                {"solid-soft", l.solid_soft},
                                {"soft-wall", l.soft_wall},
                                {"soft-soft", l.soft_soft}});
  for (const auto& [before, now] : kOldNames) {
    const std::string name = fmt::format("\"{}\"", now);
    for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1))
      text.replace(at, name.size(), fmt::format("\"{}\"", before));
  }
  return short_hash(text);
}

LawIdentity identity_of(LawForm form, double solid_fraction, const MacroSpec& spec, const SoftParticleSpec& measured,
                        const SoftLaws& laws) {
  const auto known = [](double x) { return is_known(x) ? std::optional(x) : std::nullopt; };
  return {form,         solid_fraction, spec.youngs_modulus, known(measured.poisson_ratio), known(measured.friction),
          hash_of(laws)};
}

/// A branch that was not measured is none; what stands in for other numbers that were not is said.
std::string assumed_values(const LawTableEntry& entry, const LawSources& sources) {
  if (sources.unloading && !entry.unloading_measured)
    throw InputError(
        fmt::format("unloading = true: unloading was not measured at solid fraction {:.4f} of the law table: "
                    "measure it (path = \"unload\"), or leave it out",
                    entry.solid_fraction));
  if (entry.slide_plane.measured && entry.slide_solid.measured && entry.slide_soft.measured) return "";
  return slides_text(entry);
}

/// A card serves grains of another nu or mu at the scene's own risk; what is inside a soft particle of an experiment is
/// not known.
std::function<std::string(const System3&)> measured_note(const LawCard& card, const MacroSpec& spec) {
  const SoftParticleSpec& measured = card.spec;
  std::string text = kt_remark(card);
  if (!card.from_experiment() && (measured.poisson_ratio != spec.poisson_ratio || measured.friction != spec.friction))
    append_part(
        text,
        fmt::format("the law card was measured with nu = {:g}, mu = {:g}, the grains of this scene have nu = {:g}, "
                    "mu = {:g}",
                    measured.poisson_ratio, measured.friction, spec.poisson_ratio, spec.friction));
  if (text.empty()) return nullptr;
  return [text](const System3&) { return text; };
}

bool has_soft(const System3& s) {
  const auto& material = s.particles.material;
  return std::ranges::find(material, 1) != material.end();  // of make_law_system
}

bool has_unloading(const LawCard& card) {
  return std::ranges::any_of(card.pairs, [](const PairLaw& law) { return law.unloading.has_value(); });
}

std::function<std::string(const System3&)> card_note(const LawCard& card, const MacroSpec& spec, bool unloading) {
  const auto measured = measured_note(card, spec);
  const std::string unloads = unloading && has_unloading(card) ? "" : no_unloading_text(spec, "the pair law");
  if (unloads.empty()) return measured;
  return [measured, unloads](const System3& s) {
    std::string text = measured ? measured(s) : "";
    if (has_soft(s)) append_part(text, unloads);
    return text;
  };
}

/// Keys that choose among what a table offers.
constexpr const char* kRatioKey = "unloading_ratio";
constexpr std::array kTableKeys{"solid_fraction", "range", "mu", kRatioKey, "rolling"};

/// A branch that the card does not have cannot be asked for.
void require_card_unloading(const SceneTable& t, const LawSources& sources) {
  const LawCard* card = sources.card();
  if (card != nullptr && sources.table() == nullptr && sources.unloading && !has_unloading(*card))
    t.add_error("unloading",
                "unloading was not measured for the law card: a press test with an unloading branch gives it");
}

void read_table_choices(const SceneTable& t, LawSources& out) {
  if (t.has("solid_fraction"))
    out.solid_fraction = t.number({"solid_fraction",
                                   "law table: solid fraction inside the soft particles; between two entries of the "
                                   "table the parameters are interpolated",
                                   "mean of the packings in the twin; without a twin that of the main entry"},
                                  Unit::none, Range{0.0, 1.0, true, false});
  out.beyond = read_beyond(t);
  out.range = t.choice<RangePolicy>({"range", "law table: what becomes of solid fractions outside the measured range"},
                                    RangePolicy::reject);
  if (t.has("mu"))
    out.friction =
        t.number({"mu", "law table: friction of soft particles", "as measured"}, Unit::none, Range::friction());
  out.unloading = t.flag({"unloading", "true: use the unloading branch, which must have been measured",
                          "true for a law card that has one, else false"},
                         false);
  out.card_unloading = out.unloading || !t.has("unloading");
  out.unloading_ratio = t.number({kRatioKey,
                                  "law table, isotropic form: stiffness of a soft particle in unloading over that in "
                                  "loading; above 1 it remembers its largest volume at rest"},
                                 Unit::none, Range::closed(1.0, 3.0), out.unloading_ratio);
  out.rolling = t.flag({"rolling", "law table: true: use the rolling resistance, if measured"}, true);
}

/// A memory is of whole particles under one pressure: `form_key` is what asks for that form. Where the table is known,
/// its best form will do.
void require_remembering(const SceneTable& t, const LawSources& law, const char* form_key) {
  if (!(law.unloading_ratio > 1.0)) return;
  const auto is_isotropic = [&](const WantedForm& form) {
    if (form || law.table() == nullptr) return form.value_or(LawForm::isotropic) == LawForm::isotropic;
    return std::ranges::all_of(law.table()->entries,
                               [](const LawTableEntry& entry) { return entry.best == LawForm::isotropic; });
  };
  if (law.unloading)
    t.add_error(kRatioKey, "goes without unloading = true: a memory of particles or of contacts, not of both");
  else if (!std::ranges::all_of(law.forms, is_isotropic))
    t.add_error(kRatioKey, fmt::format("goes with the isotropic form alone: {}", form_key));
}

std::vector<WantedForm> read_forms(const SceneTable& law, bool has_table) {
  std::vector<WantedForm> forms;
  for (const std::string& word :
       law.texts({"forms", "forms to compare: `pair`, `isotropic`, `directional`", "all available"})) {
    const auto form = parse_enum<LawForm>(word);
    if (!form) law.throw_error("forms", "\"" + word + "\" is none of pair, isotropic, directional");
    if (form != LawForm::pair && !has_table)
      law.throw_error("forms", "the " + word + " law needs a law table (key table)");
    forms.emplace_back(form);
  }
  return forms;
}

/// A solid fraction that the scene names is refused where it stands.
void require_fraction(const SceneTable& t, const LawSources& sources) {
  if (!sources.solid_fraction || sources.table() == nullptr) return;
  std::string ignored;
  try {
    (void)law_entry(sources, 0.0, ignored);
  } catch (const InputError& e) {
    t.add_error("solid_fraction", e.what());
  }
}

NamedLaws table_law_of(const LawSources& sources, WantedForm wanted, const MacroSpec& spec, double contents_fraction) {
  std::string remark;
  const LawTableEntry entry = law_entry(sources, contents_fraction, remark);
  constexpr double kApart = 0.005;
  if (contents_fraction > 0.0 && std::abs(contents_fraction - entry.solid_fraction) > kApart)
    append_part(remark, fmt::format("the law was taken at solid fraction {:.4f}, the contents of the twins have {:.4f}",
                                    entry.solid_fraction, contents_fraction));
  require_same_material(entry, spec);
  const std::string stands_in = assumed_values(entry, sources);
  if (!stands_in.empty()) append_part(remark, stands_in);
  if (sources.unloading_ratio > 1.0)
    append_part(remark, fmt::format("soft particles unload {:g} times as steeply as they load (unloading_ratio)",
                                    sources.unloading_ratio));
  const LawForm form = wanted.value_or(entry.best);
  MultiContactChoices choices;
  choices.form = form;
  choices.modulus = spec.youngs_modulus;
  choices.friction = sources.friction.value_or(-1.0);
  choices.unloading = sources.unloading;
  choices.unloading_ratio = sources.unloading_ratio;
  choices.rolling = sources.rolling;
  choices.beyond = sources.beyond;
  const MultiContactLaws laws = make_multi_contact_laws(entry, choices);
  choices.friction = spec.wall_friction;
  choices.wall_friction = spec.wall_friction;
  const std::string unloads =
      sources.unloading || sources.unloading_ratio > 1.0
          ? ""
          : no_unloading_text(spec, entry.unloading_measured
                                        ? fmt::format("the {} law as it is taken (unloading = true takes the branch "
                                                      "that was measured)",
                                                      to_string(form))
                                        : fmt::format("the {} law", to_string(form)));
  const RangeCheck check(entry, form);
  const SoftLaws soft{laws.soft_solid, laws.solid_soft, make_multi_contact_laws(entry, choices).soft_plane,
                      laws.soft_soft};
  return {to_string(form),
          form,
          soft,
          identity_of(form, entry.solid_fraction, spec, entry.spec, soft),
          tag_of(entry, sources, form),
          [=](const System3& s) {
            std::string text = remark;
            for (const std::string& one : {check.note(s), has_soft(s) ? unloads : std::string()})
              if (!one.empty()) append_part(text, one);
            return text;
          },
          [=](const System3& s) { return check.warning(s); }};
}

template <class Content>
const Content* content_of(const std::vector<FittedLaw>& laws) {
  for (const FittedLaw& law : laws)
    if (const auto* content = std::get_if<Content>(&law.content)) return content;
  return nullptr;
}

}  // namespace

const LawCard* LawSources::card() const { return content_of<LawCard>(laws); }
const LawTable* LawSources::table() const { return content_of<LawTable>(laws); }
const CellCard* LawSources::cells() const { return content_of<CellCard>(laws); }

const FittedLaw& LawSources::serving(WantedForm form) const {
  const bool pair = form == LawForm::pair;
  const auto wanted = std::ranges::find_if(laws, [&](const FittedLaw& law) { return (law.card() != nullptr) == pair; });
  return wanted != laws.end() ? *wanted : laws.front();
}

std::vector<std::string> LawSources::files() const {
  std::vector<std::string> out;
  for (const FittedLaw& law : laws)
    if (!law.path.empty()) out.push_back(law.path);
  return out;
}

std::vector<std::string> LawSources::remarks() const {
  std::vector<std::string> out;
  for (const FittedLaw& law : laws)
    if (!law.remark.empty()) out.push_back("law library: " + law.remark);
  return out;
}

std::string LawSources::text() const {
  std::string out;
  for (const FittedLaw& law : laws) out += law.text;
  return out;
}

double law_fraction(const LawSources& sources, double contents_fraction) {
  if (sources.solid_fraction) return *sources.solid_fraction;
  return contents_fraction > 0.0 ? contents_fraction : main_entry(*sources.table()).solid_fraction;
}

LawTableEntry law_entry(const LawSources& sources, double contents_fraction, std::string& remark) {
  return entry_at(*sources.table(), law_fraction(sources, contents_fraction), sources.range, remark,
                  sources.solid_fraction ? kReachOfNumbers : kReachOfPackings);
}

const SoftParticleSpec& measured_spec(const LawSources& sources) {
  if (const LawCard* card = sources.card()) return card->spec;
  const double wanted = law_fraction(sources, 0.0);
  const std::vector<LawTableEntry>& entries = sources.table()->entries;
  return std::min_element(entries.begin(), entries.end(),
                          [wanted](const auto& a, const auto& b) {
                            return std::abs(a.solid_fraction - wanted) < std::abs(b.solid_fraction - wanted);
                          })
      ->spec;
}

NamedLaws pair_law_of(const LawCard& card, const MacroSpec& spec, const std::string& name,
                      std::optional<Extrapolation> beyond, bool unloading) {
  const auto contact = [&](PairKind kind) {
    return make_card_law(card, kind, spec.youngs_modulus, spec.friction, 0.0, spec.kt_secant, beyond, unloading);
  };
  const SoftLaws laws = pair_soft_laws(contact(PairKind::soft_solid), contact(PairKind::soft_soft), spec.wall_friction);
  return {name,
          LawForm::pair,
          laws,
          identity_of(LawForm::pair, 0.0, spec, card.spec, laws),
          (beyond ? to_string(*beyond) : "") + (unloading || !has_unloading(card) ? "" : "loading"),
          card_note(card, spec, unloading)};
}

FittedLaw law_of_key(const SceneTable& table, const std::string& key, const std::string& path) {
  FittedLaw law = law_at(table, path);
  if (key == "card" ? law.card() == nullptr : law.table() == nullptr)
    table.throw_error(key, path + " is no law " + key + " but a " + kind_text(law));
  return law;
}

LawSources read_law_sources(const Scene& scene, const SceneTable& law) {
  LawSources out;
  std::vector<std::pair<std::string, std::string>> files;  // by key; read when all choices are known
  for (const Key& key : {Key{"card", "law card (pair law, as published)"},
                         Key{"table", "law table; `table`, `card` or both must be given"}})
    if (law.has(key.name)) files.emplace_back(key.name, law_path(scene, law.filled_text(key)));
  const bool with_table = law.has("table");
  if (files.empty()) law.throw_error("table", "give a law table, a law card, or both");
  if (law.has("forms")) out.forms = read_forms(law, with_table);
  read_table_choices(law, out);
  if (with_table) {
    require_remembering(law, out, "forms = [\"isotropic\"]");
  } else {
    out.forms = {LawForm::pair};
    law.refuse({"form"}, "goes with a law table; a card holds the pair law alone");
    law.refuse(kTableKeys, "goes with a law table (key table)");
  }
  std::vector<std::string> paths;
  for (const auto& [key, path] : files) {
    out.laws.push_back(law_of_key(law, key, path));
    paths.push_back(path);
  }
  require_card_unloading(law, out);
  refuse_idle_library(law, paths);
  require_fraction(law, out);
  return out;
}

namespace {

/// Whatever the law is.
void read_choices(const SceneTable& root, LawSources& out) {
  out.forms = {parse_enum<LawForm>(root.choice({"form",
                                                "law table: form of the law, `best`: the one that predicts left-out "
                                                "loadings best; `cell`: with a card of the cell law"},
                                               {"pair", "isotropic", "directional", "cell", "best"}, "best"))};
  read_table_choices(root, out);
}

constexpr const char* kIsotropicForm = "form = \"isotropic\"";

}  // namespace

void read_law_choices(const SceneTable& root, LawSources& out) {
  read_choices(root, out);
  require_remembering(root, out, kIsotropicForm);
}

LawSources read_scene_law(const SceneTable& root, const std::string& path) {
  LawSources out;
  read_choices(root, out);
  out.laws = {law_at(root, path)};
  refuse_idle_library(root, {path});
  const bool asks_cells = root.has("form") && root.text("form") == "cell";
  if (out.cells() != nullptr) {
    if (!asks_cells) root.refuse({"form"}, path + " is a card of the cell law: \"cell\"");
    root.refuse({"solid_fraction", "range", "mu", "unloading", kRatioKey, "rolling", "beyond"},
                "goes with laws of soft particles; " + path + " is a card of the cell law");
    return out;
  }
  if (asks_cells)
    root.refuse({"form"}, "\"cell\" goes with a card of the cell law, and " + path + " is a law of soft particles");
  require_fraction(root, out);
  if (out.card() == nullptr) {
    require_remembering(root, out, kIsotropicForm);
    return out;
  }
  const std::string pair_alone = "goes with a law table; " + path + " is a law card, which holds the pair law alone";
  if (out.forms.front() != LawForm::pair) root.refuse({"form"}, pair_alone);
  root.refuse(kTableKeys, pair_alone);
  require_card_unloading(root, out);
  return out;
}

NamedLaws law_of_form(const LawSources& sources, WantedForm form, const MacroSpec& spec, double contents_fraction) {
  const FittedLaw& file = sources.serving(form);
  return complaining_of(file, [&] {
    return file.card() != nullptr ? pair_law_of(*file.card(), spec, "pair", sources.beyond, sources.card_unloading)
                                  : table_law_of(sources, form, spec, contents_fraction);
  });
}

NamedLaws scene_law(const LawSources& sources, const MacroSpec& spec, double contents_fraction,
                    const std::string& name) {
  NamedLaws law = law_of_form(sources, sources.forms.front(), spec, contents_fraction);
  law.name = name;
  return law;
}

void add_law_texts(const NamedLaws& law, const System3& end, MacroCurve& curve) {
  const auto add = [&](const std::function<std::string(const System3&)>& say, std::string& text) {
    const std::string said = say ? say(end) : "";
    if (!said.empty()) append_part(text, said);
  };
  add(law.note, curve.note);
  add(law.warning, curve.warning);
}

std::vector<NamedLaws> laws_for(const LawSources& sources, const MacroSpec& spec, double contents_fraction) {
  std::vector<NamedLaws> laws;
  for (const WantedForm form : sources.forms) laws.push_back(law_of_form(sources, form, spec, contents_fraction));
  return laws;
}

}  // namespace softgrain
