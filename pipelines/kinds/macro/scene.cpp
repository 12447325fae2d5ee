// Reads scenes of kind "macro" as a whole, with their law.
#include "pipelines/kinds/macro/scene.h"

#include <algorithm>

#include "common/contact/rolling_scene.h"
#include "macrosim/test_protocol.h"
#include "pipelines/kinds/macro/room.h"
#include "pipelines/kinds/macro/stages.h"
#include "pipelines/kinds/soft_particle/snapshot_recorder.h"
#include "pipelines/law/law_library_scene.h"

namespace softgrain {

/// What sets the state of cells at the start.
enum class CellStartFrom { pressure, density };

template <>
inline constexpr auto enum_names<CellStartFrom> = enum_name_list<CellStartFrom>({{CellStartFrom::pressure, "pressure"},
                                                                                 {CellStartFrom::density, "density"}});

namespace {

/// What a card of the cell law knows of grains.
SoftParticleSpec grains_of(const CellCard& card) {
  SoftParticleSpec spec;
  spec.youngs_modulus = card.youngs_modulus;
  spec.density = card.density;
  spec.poisson_ratio = card.poisson_ratio;
  spec.friction = card.grain_friction;
  return spec;
}

/// [material] of a scene with cells: the numbers of a cell law are over E, so that it serves any; nu and mu it does
/// not.
void read_cell_material(const SceneTable& root, SoftParticleSpec& spec) {
  const SceneTable material = root.table_or_empty(
      {"material", "material of the grains, with a card of the cell law only; nu and mu are those of the card"});
  for (const char* key : {"nu", "mu"})
    if (material.has(key))
      material.add_error(key, "goes without: the cell law was measured with a nu and mu and serves no others");
  spec.youngs_modulus = material.number({"E", "Young's modulus of the grains; scales all stresses", "as the card"},
                                        Unit::pressure, Range::positive(), spec.youngs_modulus);
  spec.density =
      material.number({"density", "density of the grains, for the column `bulk_density` of `macro.h5`", "as the card"},
                      Unit::density, Range::positive(), spec.density);
}

/// Whether E is said, by the law or for cells by [material]: not by a scene that is read without its law.
bool says_modulus(const SceneTable& root, const std::string& law_file) {
  return !law_file.empty() || (root.has("fines") && root.table_or_empty("material").has("E"));
}

/// A stress in Pa says nothing where nobody says the E that stresses of the law are over.
void require_known_modulus(const SceneTable& root, const std::string& law_file) {
  const auto refuse = [&](const SceneTable& table, const char* key) {
    table.add_error(key, "a stress in Pa needs E of the grains, which " + law_file +
                             " does not say (its pressures are over E): give it, [material] E = \"50 GPa\" say");
  };
  const SceneTable macro = root.table("macro");
  if (macro.is_text("start_pressure")) refuse(macro, "start_pressure");  // a number is over E
  std::vector<SceneTable> tables = root.tables("stage");
  tables.push_back(macro);
  for (const SceneTable& table : tables)
    for (const char* key : {"stress", "lateral_stress", "stress_x", "stress_y", "stress_z", "modulus_stress"})
      if (table.has(key)) refuse(table, key);
}

/// What a scene says of fines; the card of their law is not read here.
CellMatter read_fines(const SceneTable& root) {
  const SceneTable fines = root.table(
      {"fines",
       "fines that fill all the space between the particles; needed with a card of the cell law, and only with one"});
  CellMatter matter;
  matter.share = fines.number({"share", "share of fines in the solid volume; they are not in the list of grains"},
                              Unit::none, Range{0.0, 1.0, true, true});
  matter.solid_fraction = fines.number({"solid_fraction", "solid fraction of the mixture at the start",
                                        "that of the card for this mixture at `start_pressure`"},
                                       Unit::none, Range{0.0, 1.0, true, true}, 0.0);
  matter.at_density = fines.choice<CellStartFrom>({"start",
                                                   "quantity that sets the initial state of the cells: `\"pressure\"` "
                                                   "(`start_pressure`) or `\"density\"` (`solid_fraction`)"},
                                                  CellStartFrom::pressure) == CellStartFrom::density;
  const Key preparation{"preparation",
                        "preparation of the material: void ratios are those of the card times its factor for it, 1 for "
                        "its own. Where it is said, the critical state of a card with memory follows `start_pressure`",
                        "that of the card"};
  if (fines.has("preparation")) matter.preparation = to_string(fines.choice<Preparation>(preparation));
  return matter;
}

/// [fines], and what goes with cells in [macro].
void read_cells(const SceneTable& root, const SceneTable& macro, const CellCard& card, MacroSetup& setup) {
  MacroSpec& spec = setup.spec;
  if (!macro.has("soft_share") && !setup.given) spec.soft_share = 0.0;
  if (macro.has("resolved") && !setup.twins.empty())
    macro.add_error("resolved",
                    "what a cell law is compared with is the material with all its grains: see kind "
                    "\"material-models\"");
  setup.twins.clear();
  if (spec.preparation == Preparation::lammps)
    macro.add_error("preparation", "\"lammps\" knows no cells: frictionless, fast, slow or dense");
  if (spec.construction == Construction::voids)
    macro.add_error("construction", "\"voids\" goes with soft particles in shells; cells fill all voids");
  if (spec.soft_share >= 1.0) macro.add_error("soft_share", "cells need solid grains: must be below 1");
  macro.refuse({"wall_mu"}, "walls of cells are smooth");
  macro.refuse({"kt"}, "the tangential stiffness of cells is that of the card");
  macro.refuse(kRollingKeys, "is that of the card, whose grains were measured with it");
  spec.rolling = card.grain_rolling;
  macro.refuse({"law_increments", "noise_samples"},
               "goes with laws of soft particles; increments_per_step serves cells");
  macro.refuse({"band_estimator"}, "cells run every draw");
  setup.band_estimator = BandEstimator::draws;
  macro.refuse({"force_floor"}, "cells have no contact forces: their residual is over the mean load of a face");
  macro.refuse(kDensityKeys, "is said of the mixture: [fines] solid_fraction, with start = \"density\"");
  CellMatter matter = read_fines(root);
  matter.card = card;
  if (!void_ratio_factor(card, matter.preparation))
    root.table_or_empty("fines").add_error("preparation", missing_factor_text(card, matter.preparation));
  if (setup.given && matter.solid_fraction > 0.0)
    root.table_or_empty("fines").add_error("solid_fraction", "goes without packing, whose box says it");
  spec.cells = matter;
}

/// States that are kept unless the scene says how many: enough to see the test go on, where a scene is small.
std::int64_t states_to_see(const MacroSpec& spec) {
  constexpr std::int64_t kSmall = 1000;  // bodies
  constexpr std::int64_t kOfSmall = 11;
  return spec.bodies <= kSmall ? kOfSmall : kKeptStates;
}

const Key kLawKey{"law",
                  "law card, law table, card of the cell law, or the table of a press test (a law is fitted); path "
                  "relative to the scene. `library`: the law of `[library]`, from the library of the program",
                  "-, unless `--law` names one"};

MacroScene read_with_law(const SceneTable& root, const std::string& law_file) {
  (void)root.choice(kKindKey, {"macro"});
  MacroScene out;
  out.title = root.title();
  out.seed = static_cast<std::uint64_t>(root.count(kSeedKey, 0, 1000000000000, 1));
  out.law_file = law_file;
  if (law_file.empty()) {
    read_law_choices(root, out.law);
  } else {
    out.law = read_scene_law(root, law_file);
    out.spec = out.law.cells() != nullptr ? grains_of(*out.law.cells()) : measured_spec(out.law);
  }
  const CellCard* cells = out.law.cells();
  if (law_file.empty() ? root.has("fines") : cells != nullptr)
    read_cell_material(root, out.spec);
  else if (root.has("material"))
    root.add_error("material",
                   "goes without: the materials of all bodies are those of the law, which was measured with them");
  const bool modulus_is_known = !root.has_errors() && says_modulus(root, law_file);
  const SceneTable macro = root.table({"macro", "solid grains and soft particles, their preparation and their test"});
  out.setup = read_macro_setup(macro, out.spec);
  read_stages(root, macro, out.setup.spec, modulus_is_known);
  refuse_idle_test_keys(macro, root, {&out.setup.spec});
  if (cells != nullptr) {
    read_cells(root, macro, *cells, out.setup);
    if (any_slides(stages_of(out.setup.spec)))
      macro.add_error(root.has("stage") ? "stage" : "test",
                      "cells of fines are rectangular: simple-shear and "
                      "direct-shear go with a law of contacts");
    if (!is_known(out.spec.youngs_modulus)) require_known_modulus(root, law_file);
  } else {
    if (!law_file.empty()) root.refuse({"fines"}, "goes with a card of the cell law (see the guide)");
    require_known_contents(macro, out.setup, out.spec, law_file);
  }
  if (!root.has_errors()) require_macro_memory(macro, out.setup, out.spec);
  if (!root.has_errors()) require_room_for_images(macro, "bodies", out.setup, out.seed);
  refuse_idle_keys(macro, !out.setup.twins.empty(), true);  // --bands may give some
  refuse_idle_sizes(macro, {&out.setup});
  if (out.law.table() != nullptr)
    macro.refuse({"kt"}, "goes with a law card; a law table has one tangential stiffness");
  if (const LawCard* card = out.law.card(); card != nullptr && std::ranges::none_of(card->pairs, has_tangential))
    macro.refuse({"kt"}, "no tangential stiffness was measured for " + law_file + ": one is assumed");
  if (out.setup.twins.empty())
    root.refuse({"contents"}, "is of the soft particles of a resolved twin: goes with resolved = true");
  out.setup.kept_states = read_kept_states(root, states_to_see(out.setup.spec));
  out.contents =
      root.count({"contents", "number of different packings in the soft particles of the twin; refused without a twin"},
                 1, 100000, out.contents);
  return out;
}

}  // namespace

MacroScene read_macro_scene(const Scene& scene, const std::string& law) {
  return scene.read([&](const SceneTable& root) {
    const std::string written = root.filled_text(kLawKey, "");
    return read_with_law(root, !law.empty() || written.empty() ? law : law_path(scene, written));
  });
}

MacroScene read_macro_scene_alone(const Scene& scene) {
  return scene.read([](const SceneTable& root) {
    (void)root.filled_text(kLawKey, "");
    if (root.has("fines")) (void)read_fines(root);
    if (root.has("library")) read_library_keys(root);
    return read_with_law(root, "");
  });
}

}  // namespace softgrain
