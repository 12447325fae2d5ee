// Laws of soft particles by the name under which a macro run uses them.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/data/cell_card.h"
#include "common/data/macro_result.h"
#include "common/io/scene.h"
#include "macrosim/macro_spec.h"
#include "macrosim/macro_system.h"
#include "pipelines/law/fitted_law.h"

namespace softgrain {

struct NamedLaws {
  std::string name;  ///< engine of the curves: "law" or "pair", "isotropic", "directional"
  LawForm form = LawForm::pair;
  SoftLaws laws;
  LawIdentity identity{};
  std::string tag;  ///< changes with the numbers of the law: part of the name of checkpoints; empty: none
  /// Text about the end of a run: contacts that no measurement covers. Empty when there is nothing to say; the function
  /// may be empty.
  std::function<std::string(const System3&)> note;
  /// Text about what may make the result wrong: contacts deeper than any that was measured.
  std::function<std::string(const System3&)> warning{};
  std::optional<CellCard> cells{};  ///< a cell law with other numbers than that of the scene, in place of `laws`
};

/// The pair law of a card; `beyond` instead of what the card says; `unloading`: with the branches that the card has.
/// Throws InputError when the card has no usable law.
NamedLaws pair_law_of(const LawCard& card, const MacroSpec& spec, const std::string& name,
                      std::optional<Extrapolation> beyond = std::nullopt, bool unloading = true);

/// What a law has to say about the end of a run goes to the note and the warning of its curve.
void add_law_texts(const NamedLaws& law, const System3& end, MacroCurve& curve);

/// Where a scene takes its laws from: table [law] of a comparison, keys of a macro scene.
struct LawSources {
  /// One law; of a comparison a card (pair law, as published), a table (isotropic and directional law, and the pair law
  /// when there is no card) or both. A card of the cell law (fines without shells) is the only law of a macro scene.
  std::vector<FittedLaw> laws;
  std::vector<WantedForm> forms{LawForm::pair, LawForm::isotropic, LawForm::directional};  ///< one for a macro scene
  std::optional<double> solid_fraction{};   ///< solid fraction at which the table is taken; empty: see law_fraction()
  RangePolicy range = RangePolicy::reject;  ///< policy for solid fractions outside the table
  std::optional<double> friction;           ///< mu_soft of the table's laws; empty: as measured
  bool unloading = false;                   ///< whether the measured unloading branch of a table is used
  bool card_unloading = true;               ///< whether the unloading branches of a card are used
  double unloading_ratio = 1.0;             ///< stiffness of soft particles in unloading over that in loading
  bool rolling = true;                      ///< whether the measured rolling resistance is used
  std::optional<Extrapolation> beyond{};    ///< policy beyond the range, instead of that of card or table

  [[nodiscard]] const LawCard* card() const;
  [[nodiscard]] const LawTable* table() const;
  [[nodiscard]] const CellCard* cells() const;
  /// The law that runs of this form take: the card serves the pair law, the table all others; a single law serves all.
  [[nodiscard]] const FittedLaw& serving(WantedForm form) const;
  [[nodiscard]] std::vector<std::string> files() const;  ///< files that the laws come from
  [[nodiscard]] std::string text() const;                ///< content of these files
  /// What a library says of the laws that it gave: nearest material, press test, numbers that are means.
  [[nodiscard]] std::vector<std::string> remarks() const;
};

/// Solid fraction at which a table is taken: what the scene says, else the mean of the contents of its soft particles,
/// else (0: there are none) that of the main entry.
double law_fraction(const LawSources& sources, double contents_fraction);

/// Entry of the table at law_fraction(), with a remark (or none) on what that means. Throws InputError (policy reject).
LawTableEntry law_entry(const LawSources& sources, double contents_fraction, std::string& remark);

/// The soft particles that the law of a scene was measured on, and the contents of its twins; of a table those of the
/// entry nearest to the solid fraction that the scene says, else of the main one.
const SoftParticleSpec& measured_spec(const LawSources& sources);

/// The law in the file that a key names. Throws InputError where a key `card` names no law card, `table` no law table.
FittedLaw law_of_key(const SceneTable& table, const std::string& key, const std::string& path);

/// Reads [law]; paths are relative to the scene. Throws InputError, IoError.
LawSources read_law_sources(const Scene& scene, const SceneTable& law);

/// The one law of a macro scene: key `beyond`, and keys `form` (default the best of the table; a card has the pair law
/// only, a card of the cell law "cell"), `solid_fraction`, `range`, `mu`, `unloading` and `unloading_ratio` of `root`,
/// which go with tables, and the card or table at `path`. Throws InputError, IoError.
LawSources read_scene_law(const SceneTable& root, const std::string& path);

/// The keys of read_scene_law() alone, for scenes that are read without their law. Throws InputError.
void read_law_choices(const SceneTable& root, LawSources& out);

/// The law that serves this form, under the name of its form. Of a table: at law_fraction(); an empty form is the one
/// that the entry prefers. Throws InputError when there is no usable law of the form, and of a table when it was
/// measured with grains of another nu or mu, or does not reach this solid fraction (policy reject).
NamedLaws law_of_form(const LawSources& sources, WantedForm form, const MacroSpec& spec, double contents_fraction);

/// The law of the first form, under the name `name`: the one that read_scene_law() chose.
NamedLaws scene_law(const LawSources& sources, const MacroSpec& spec, double contents_fraction,
                    const std::string& name);

/// Every law that a comparison runs with, in the order of its tables and figures.
std::vector<NamedLaws> laws_for(const LawSources& sources, const MacroSpec& spec, double contents_fraction);

}  // namespace softgrain
