#include "pipelines/kinds/recipe/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/packing/grading.h"
#include "common/packing/grading_scene.h"
#include "macrosim/test_protocol.h"
#include "pipelines/compare/stage_results.h"
#include "pipelines/kinds/macro/room.h"
#include "pipelines/kinds/macro/stages.h"
#include "pipelines/kinds/material/run.h"
#include "pipelines/kinds/material_law/fines_in_cells.h"
#include "pipelines/kinds/recipe/run.h"
#include "pipelines/kinds/recipe/stages.h"
#include "pipelines/kinds/soft_particle/snapshot_recorder.h"

namespace softgrain {

namespace {

/// A mixture with fewer coarse or fine grains than this tells nothing; with fewer than the second it scatters.
constexpr double kLeastGrains = 8.0;
constexpr double kFewGrains = 30.0;
/// Least volume of a level, of all.
constexpr double kLeastShare = 0.005;
/// A sample should have so many grains above a third of the largest radius.
constexpr double kCoarseGrains = 60.0;

/// One E, nu and mu: packings of one material are measured, and the equation of state is over its E.
void refuse_own_material(const SceneTable& t) {
  for (const char* key : {"E", "nu", "mu", "mu_r", "kr_ratio"})
    if (t.has(key))
      t.add_error(key,
                  "goes into [material]: contacts between constituents of different stiffness or friction are not "
                  "measured, all grains have one E, nu and mu (their mean, by volume)");
}

/// The share, or a mass, of which read_constituents() makes the share.
double read_mass(const SceneTable& t) {
  if (!t.has("mass"))
    return t.number({"mass_share", "share in the mass of all constituents; the shares add up to 1"}, Unit::none,
                    Range{0.0, 1.0, true, false});
  t.refuse({"mass_share"}, "goes without mass, of which the shares are made");
  return t.number({"mass",
                   "mass in the mix, in one unit for all (kg in a cubic metre, parts), instead of `mass_share`: other "
                   "masses keep their ratios when one is changed"},
                  Unit::none, Range::positive());
}

Constituent read_constituent(const SceneTable& t, double density) {
  Constituent c;
  t.section([&] {
    c.name = t.text({"name", "name of the constituent"});
    c.mass_share = read_mass(t);
    c.density = t.number({"density", "density of its grains", "that of `[material]`"}, Unit::density, Range::positive(),
                         density);
    refuse_own_material(t);
    c.sizes = read_sizes(t, {"sizes", "its size distribution, such as a sieve curve"}, {});
    if (!t.has("sizes")) t.add_error("sizes", "is missing: a sieve curve, or another law of sizes");
  });
  return c;
}

/// The density of the material is that of constituents that do not say their own.
void refuse_idle_density(const SceneTable& root) {
  const std::vector<SceneTable> all = root.tables("constituent");
  if (all.empty() || !root.has("material")) return;
  if (std::all_of(all.begin(), all.end(), [](const SceneTable& t) { return t.has("density"); }))
    root.table("material").refuse({"density"}, "every [[constituent]] gives its own");
}

std::vector<Constituent> read_constituents(const SceneTable& root, double density) {
  std::vector<Constituent> out;
  double sum = 0.0;
  std::size_t by_mass = 0;
  for (const SceneTable& t :
       root.tables({"constituent", "one of the constituents, instead of one size distribution in `[grains]`"})) {
    out.push_back(read_constituent(t, density));
    sum += out.back().mass_share;
    by_mass += t.has("mass") ? 1 : 0;
    if (std::count_if(out.begin(), out.end(), [&](const Constituent& c) { return c.name == out.back().name; }) > 1)
      t.add_error("name", "is used twice");
  }
  if (out.empty() || root.has_errors()) return out;
  if (by_mass > 0 && by_mass < out.size()) {
    root.add_error("constituent", "either all of them give mass, or all give mass_share");
    return out;
  }
  if (by_mass == out.size())
    for (Constituent& c : out) c.mass_share /= sum;
  else if (std::abs(sum - 1.0) > 1e-6)
    root.add_error("constituent", fmt::format("the mass shares add up to {:g}; they must add up to 1", sum));
  double volume = 0.0;
  for (const Constituent& c : out) volume += c.mass_share / c.density;
  for (Constituent& c : out) c.volume_share = c.mass_share / c.density / volume;
  return out;
}

/// Sizes of all constituents together, by solid volume.
Grading mixed_sizes(const std::vector<Constituent>& constituents) {
  std::vector<SizePiece> pieces;
  for (const Constituent& c : constituents)
    for (SizePiece p : c.sizes->pieces()) {
      p.volume *= c.volume_share;
      pieces.push_back(p);
    }
  return Grading::classes(std::move(pieces));
}

/// [levels]: where the curve is cut.
struct WantedCuts {
  double ratio = 3.2;
  std::vector<double> given{};  ///< radii [m]; empty: by the ratio
};

WantedCuts read_cuts(const SceneTable& t) {
  WantedCuts out;
  out.ratio = t.number({"ratio", "upper limit of largest over smallest diameter in a level; cuts are at equal ratios"},
                       Unit::none, Range::closed(1.5, 10.0), out.ratio);
  if (!t.has("cut_diameters")) return out;
  t.refuse({"ratio"}, "goes without cut_diameters, which say where the curve is cut");
  out.given = t.numbers({"cut_diameters", "diameters at which the curve is cut, instead of `ratio`"}, Unit::length,
                        Range::positive());
  if (out.given.empty()) t.add_error("cut_diameters", "at least one is needed; without the key cuts go by ratio");
  for (double& cut : out.given) cut *= 0.5;
  std::sort(out.given.begin(), out.given.end(), std::greater<>());
  if (std::adjacent_find(out.given.begin(), out.given.end()) != out.given.end())
    t.add_error("cut_diameters", "one is there twice");
  return out;
}

std::vector<double> cuts_of(const SceneTable& t, const WantedCuts& wanted, const Grading& sizes) {
  if (wanted.given.empty()) return find_cuts(sizes, wanted.ratio, kLeastShare);
  for (const double cut : wanted.given)
    if (!(cut > sizes.smallest() && cut < sizes.largest()))
      t.add_error("cut_diameters", fmt::format("{:g} mm cuts off no level: diameters go from {:g} to {:g} mm",
                                               2e3 * cut, 2e3 * sizes.smallest(), 2e3 * sizes.largest()));
  return wanted.given;
}

std::string text_of(const RecipeLevel& level) {
  return fmt::format("diameters {:.3g} to {:.3g} mm", 2e3 * level.low, 2e3 * level.high);
}

/// Levels that hold something, and neighbours that a packing can hold together.
void require_levels(const SceneTable& t, const RecipeScene& scene, std::int64_t grains) {
  const auto& levels = scene.levels;
  if (levels.size() < 2)
    t.throw_error("ratio",
                  fmt::format("the sizes make one level ({}): resolve all grains, with kind = \"material\", or cut "
                              "closer",
                              text_of(levels.front())));
  for (std::size_t k = 0; k < levels.size(); ++k)
    if (levels[k].share < kLeastShare)
      t.add_error("cut_diameters",
                  fmt::format("level {} ({}) holds {:.2g} % of the volume; {:g} % at least: cut elsewhere", k + 1,
                              text_of(levels[k]), 100.0 * levels[k].share, 100.0 * kLeastShare));
  for (std::size_t k = 0; k + 1 < levels.size(); ++k)
    for (const double share : scene.mixtures) {
      const double coarse = (1.0 - share) / mean_grain_volume(levels[k].pieces);
      const double fine = share / mean_grain_volume(levels[k + 1].pieces);
      const double least = static_cast<double>(grains) * std::min(coarse, fine) / (coarse + fine);
      if (least >= kLeastGrains) continue;
      t.add_error(
          t.has("cut_diameters") ? "cut_diameters" : "ratio",
          fmt::format("levels {} and {} ({}; {}) are too far apart for a packing of {} grains: with a share of "
                      "fines of {:g} about {:.2g} would be {}: more grains ([grains] count), or levels closer to "
                      "each other",
                      k + 1, k + 2, text_of(levels[k]), text_of(levels[k + 1]), grains, share, least,
                      coarse < fine ? "coarse" : "fine"));
      break;
    }
}

MaterialVariant variant_of(const std::string& name, const MacroSetup& base, const Grading& sizes) {
  MaterialVariant v{name, base};
  take_sizes(v.setup.spec, sizes);
  return v;
}

/// Adds a packing unless one of the same shape is there; its place.
std::size_t place_of(std::vector<MaterialVariant>& variants, MaterialVariant v) {
  const Grading& sizes = *v.setup.spec.solid_sizes;
  for (std::size_t k = 0; k < variants.size(); ++k)
    if (!variants[k].same_packings && variants[k].setup.spec.solid_sizes->same_shape(1.0, sizes, 1.0)) return k;
  variants.push_back(std::move(v));
  return variants.size() - 1;
}

/// So many of the coarsest levels as the packing of the check has grains for.
std::size_t levels_in_check(const RecipeScene& scene) {
  std::size_t most = 0;
  for (std::size_t n = 2; n <= scene.levels.size(); ++n) {
    const Grading sizes = joined(scene.levels, 0, n);
    const double third = sizes.largest() / 3.0;
    const std::vector<SizePiece> large = pieces_between(sizes, third, 2.0 * sizes.largest());
    double volume = 0.0;
    for (const SizePiece& p : large) volume += p.volume;
    const double coarse =
        static_cast<double>(scene.check.grains) * volume * mean_grain_volume(sizes.pieces()) / mean_grain_volume(large);
    if (coarse >= kCoarseGrains) most = n;
  }
  return most;
}

void make_variants(const MacroSetup& base, double shear_strain, RecipeScene& out) {
  auto& variants = out.material.variants;
  const auto& levels = out.levels;
  MacroSetup still = base;
  still.spec.preload = 0.0;
  // What is sheared follows the packings that it shares.
  MaterialVariant fines = variant_of("level-2", still, slice_of(levels[1]));
  variants.push_back(fines);
  MaterialVariant sheared = variant_of("level-2-shear", base, slice_of(levels[1]));
  sheared.same_packings = true;
  sheared.packings = fines.name;
  if (base.spec.test == MacroTest::stages) {
    shear_at_stress(sheared.setup.spec, shear_strain);
  } else {
    sheared.setup.spec.test = MacroTest::shear;
    sheared.setup.spec.strain_end = shear_strain;
  }
  variants.push_back(std::move(sheared));
  for (std::size_t k = 0; k < levels.size(); ++k)
    out.slice.push_back(place_of(variants, variant_of(fmt::format("level-{}", k + 1), still, slice_of(levels[k]))));
  for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
    out.mixed.emplace_back();
    for (const double share : out.mixtures)
      out.mixed.back().push_back(
          place_of(variants, variant_of(fmt::format("levels-{}-{}-{:.6g}", k + 1, k + 2, 100.0 * share), still,
                                        pair_of(levels[k], levels[k + 1], share))));
  }
  if (out.check.grains == 0) return;
  out.checked_levels = levels_in_check(out);
  if (out.checked_levels < 2) return;
  still.spec.bodies = out.check.grains;
  still.samples = out.check.samples;
  out.checked = variants.size();
  variants.push_back(
      variant_of(fmt::format("check-{}-levels", out.checked_levels), still, joined(levels, 0, out.checked_levels)));
}

/// Every packing gets room for the images of its largest grains: numbers that nobody asked for are raised. Those of the
/// scene are refused where grains cannot even be placed, and doubted where they may have no room when they are pressed.
class RoomForImages {
 public:
  RoomForImages(const SceneTable& root, RecipeScene& scene) : root_(root), scene_(scene) {}

  void require() {
    for (std::size_t v = 0; v < scene_.material.variants.size(); ++v) {
      MaterialVariant& variant = scene_.material.variants[v];
      if (variant.same_packings) {
        variant.setup.spec.bodies = scene_.material.variants[v - 1].setup.spec.bodies;
        continue;
      }
      const bool check = scene_.checked == v;
      const MaterialVariant* sheared = v + 1 < scene_.material.variants.size() ? &variant + 1 : nullptr;
      MacroSetup widest = variant.setup;
      if (sheared != nullptr && sheared->same_packings) widen(widest, *sheared);
      variant.setup.spec.bodies =
          enough(widest, check ? "check" : "grains", check ? "grains" : "count", "packing " + variant.name);
      if (check) scene_.check.grains = variant.setup.spec.bodies;
    }
    MacroSetup coarsest = scene_.material.variants.front().setup;
    take_sizes(coarsest.spec, Grading::classes(scene_.levels[0].pieces));
    coarsest.spec.bodies = scene_.macro.grains;
    coarsest.samples = scene_.macro.samples;
    scene_.macro.grains = enough(coarsest, "macro", "grains", "the coarsest level under load");
  }

 private:
  /// Room for both tests of a packing.
  static void widen(MacroSetup& setup, const MaterialVariant& sheared) {
    const MacroSpec& other = sheared.setup.spec;
    if (setup.spec.test != MacroTest::stages)
      setup.spec.strain_end = std::max(setup.spec.strain_end, other.strain_end + other.preload);
    else if (rough_strains(other).largest_axial > rough_strains(setup.spec).largest_axial)
      setup.spec.stages = other.stages;
  }

  /// Number of grains in this packing: those asked for or more.
  std::int64_t enough(MacroSetup setup, const char* table, const char* key, const std::string& what) {
    constexpr std::int64_t kDearest = 5;  // times the default: what is dearer should be asked for
    const std::int64_t asked = setup.spec.bodies;
    const SceneTable t = root_.table_or_empty(table);
    const auto seed = scene_.material.seed;
    if (const std::string problem = room_problem(setup, seed, "grains"); t.has(key) && !problem.empty())
      t.throw_error(key, fmt::format("{}: {} ([{}] {}); levels closer to each other ([levels] ratio) take fewer", what,
                                     problem, table, key));
    const std::string doubt = room_doubt(setup, seed, "grains");
    if (doubt.empty()) return asked;
    if (t.has(key)) {
      scene_.doubts.push_back(fmt::format("{}: {} ([{}] {})", what, doubt, table, key));
      return asked;
    }
    setup.spec.bodies = std::max(asked, least_bodies(setup.spec));
    while (setup.spec.bodies <= kDearest * asked && !room_doubt(setup, seed, "grains").empty())
      setup.spec.bodies += std::max<std::int64_t>(1, setup.spec.bodies / 10);
    if (setup.spec.bodies > kDearest * asked)
      t.throw_error(key, fmt::format("{}: {} ([{}] {}); levels closer to each other ([levels] ratio) take fewer", what,
                                     doubt, table, key));
    scene_.raised.push_back(
        fmt::format("{}: {} grains in place of the default {} ([{}] {}), for a periodic cell with room", what,
                    setup.spec.bodies, asked, table, key));
    return setup.spec.bodies;
  }

  const SceneTable& root_;
  RecipeScene& scene_;
};

void read_mixtures(const SceneTable& t, RecipeScene& out) {
  out.mixtures =
      t.numbers({"mixtures",
                 "shares of the finer level in the mixtures of two levels, by solid volume; three at least, ascending"},
                Unit::none, Range{0.0, 1.0, true, true}, {0.2, 0.4, 0.6, 0.8});
  if (out.mixtures.size() < 3)
    t.add_error("mixtures", "at least three shares are needed: w_inf and xi are fitted to them");
  if (std::adjacent_find(out.mixtures.begin(), out.mixtures.end(), std::greater_equal<>()) != out.mixtures.end())
    t.add_error("mixtures", "shares must ascend");
}

void read_rest(const SceneTable& root, RecipeScene& out) {
  const SceneTable check =
      root.table_or_empty({"check", "check of the law with a packing of the coarsest levels with all their grains"});
  out.check.grains = check.count({"grains",
                                  "grains of the check; it holds the coarsest levels: as many as possible with at "
                                  "least 60 grains above a third of the largest radius; 0: no check"},
                                 0, 10000000, out.check.grains);
  if (out.check.grains == 0) check.refuse({"samples"}, "there is no check with grains = 0");
  out.check.samples = check.count({"samples", "samples of the check"}, 1, 1000, out.check.samples);
  const SceneTable macro = root.table_or_empty({"macro", "level 1, which is loaded with the cell law"});
  out.macro.grains =
      macro.count({"grains", "grains of level 1, which is loaded with the cell law"}, 40, 100000, out.macro.grains);
  out.macro.samples =
      macro.count({"samples", "samples of level 1, which is loaded with the cell law"}, 1, 1000, out.macro.samples);
  out.macro.strain = macro.number(
      {"strain", "axial strain of the loading of level 1", "that of the test, or half of the porosity if that is less"},
      Unit::none, Range{0.0, 0.5, true, false}, out.macro.strain);
  if (!root.has("shells")) return;
  const SceneTable shells =
      root.table({"shells", "comparison with a hierarchy of soft particles; without the table there is no hierarchy"});
  out.shells.levels = shells.count({"levels", "decades of the hierarchy of soft particles"}, 2, 20, 4);
  out.shells.packings = shells.count({"packings", "packings of each decade"}, 4, 1000, out.shells.packings);
  out.shells.ratio = shells.number({"ratio", "largest over smallest radius of each decade"}, Unit::none,
                                   Range::closed(2.0, 20.0), out.shells.ratio);
  if (shells.has("form"))
    out.shells.form = shells.choice<LawForm>({"form", "form of the law of the hierarchy", "\"isotropic\""},
                                             {LawForm::isotropic, LawForm::directional, LawForm::pair});
}

/// [law]: form of the equation of state, replicates, cells, shear.
double read_law(const SceneTable& law, RecipeScene& out) {
  out.material.equation.form = law.choice<StateForm>({"form", "form of the equation of state"}, StateForm::porosity);
  out.material.equation.replicates = law.count({"replicates", "bootstrap replicates"}, 40, 100000, 400);
  out.cells = law.count({"cells", "sites of the packing of cells to which friction is fitted"}, 40, 100000, out.cells);
  return law.number(
      {"shear_strain", "logarithmic strain to which the grains of level 2 are sheared at constant volume"}, Unit::none,
      Range{0.0, 0.5, true, false}, 0.06);
}

MacroSetup recipe_defaults() {
  MacroSetup setup = material_law_defaults();
  setup.samples = 2;
  return setup;
}

/// Packings that end at a low pressure settle longer: 2.4 ms of one core for a grain at 7e-7 E, poured.
double low_pressure_factor(const MacroSpec& spec) {
  constexpr double kUsual = 1e-4;
  return spec.start_pressure < kUsual ? std::pow(kUsual / spec.start_pressure, 0.11) : 1.0;
}

/// The stresses of the tests, in Pa.
std::string stress_line(const MacroSpec& spec) {
  if (spec.test == MacroTest::stages) return "axial stresses: " + stages_text(spec);
  return fmt::format("axial stresses: from {} ({:.3g} E) to a strain of {:.3g}; [[stage]] go to given stresses",
                     pressure_text(least_stress(spec)), spec.start_pressure, spec.strain_end);
}

/// Preparing and pressing, by the three recipes of pipelines/: 1.4 ms of one core for each of 2,500 grains, more for
/// each of a larger sample [s].
double packing_seconds(const RecipeScene& scene) {
  double seconds = 0.0;
  for (const MaterialVariant& v : scene.material.variants) {
    const auto grains = static_cast<double>(v.setup.spec.bodies);
    seconds += low_pressure_factor(v.setup.spec) * 1.4e-3 * std::sqrt(grains / 2500.0) * grains *
               static_cast<double>(v.setup.samples);
  }
  return seconds;
}

}  // namespace

double fines_over_coarse(const RecipeScene& scene, std::size_t level) {
  double finer = 0.0;
  for (std::size_t k = level + 1; k < scene.levels.size(); ++k) finer += scene.levels[k].share;
  return finer / scene.levels[level].share;
}

bool tells_ways(const RecipeScene& scene) {
  constexpr std::size_t kTelling = 3;
  return scene.checked_levels >= kTelling || scene.checked_levels == scene.levels.size();
}

RecipeScene read_recipe_scene(const Scene& scene) {
  return scene.read([](const SceneTable& root) {
    (void)root.choice(kKindKey, {"recipe"});
    RecipeScene out{{}, {}, Grading::power_law(3.5, 1.0, 2.0), {}, {}, {}, {}, {}, 0, {}, {}, {}, {}, {}, 100};
    out.material.title = root.text(kTitleKey, "");
    out.material.seed = static_cast<std::uint64_t>(root.count(kSeedKey, 0, 1000000000000, 1));
    MacroSetup base = recipe_defaults();
    read_material_tables(root, base);
    const SceneTable grains = root.table("grains");
    if (base.spec.test != MacroTest::oedometric)
      root.table("test").add_error("test", "levels are measured in oedometric compression (and one of them in shear)");
    read_recipe_stages(root, base.spec);
    base.samples = root.count({"samples", "samples of each packing"}, 1, 10000, base.samples);
    base.kept_states = read_kept_states(root, 0);
    out.constituents = read_constituents(root, base.spec.density);
    refuse_idle_density(root);
    if (!out.constituents.empty())
      grains.refuse({"sizes", "exponent", "radius_max", "ratio"},
                    "goes without [[constituent]], which have sizes of their own");
    const double shear =
        read_law(root.table_or_empty({"law", "fits of the equation of state and of the cell law"}), out);
    read_rest(root, out);
    if (root.has("shells") && base.spec.rolling.friction > 0.0)
      root.add_error("shells", "goes without mu_r: soft particles are measured with grains that roll freely");
    const SceneTable levels = root.table_or_empty(
        {"levels", "cuts of the size distribution into levels, and the mixtures of neighbouring levels"});
    read_mixtures(levels, out);
    const WantedCuts wanted = read_cuts(levels);
    if (root.has_errors()) return out;
    out.sizes = out.constituents.empty() ? sizes_of(base.spec) : mixed_sizes(out.constituents);
    const std::vector<double> cuts = cuts_of(levels, wanted, out.sizes);
    if (root.has_errors()) return out;
    out.levels = levels_of(out.sizes, cuts);
    require_levels(levels, out, base.spec.bodies);
    if (root.has_errors()) return out;
    make_variants(base, shear, out);
    require_material_memory(grains, base);
    RoomForImages(root, out).require();
    for (std::size_t v = 0; v < out.material.variants.size(); ++v)
      require_material_memory(out.checked == v ? root.table_or_empty("check") : grains, out.material.variants[v].setup);
    return out;
  });
}

void check_recipe(const RecipeScene& recipe, Findings& out) {
  out.warn_of_metres("the largest grain", recipe.sizes.largest());
  for (const Constituent& c : recipe.constituents)
    out.lines += fmt::format("  {}: {:.3g} % of the mass, {:.3g} % of the solid volume\n", c.name, 100.0 * c.mass_share,
                             100.0 * c.volume_share);
  for (std::size_t k = 0; k < recipe.levels.size(); ++k)
    out.lines += fmt::format("  level {}: {}, {:.3g} % of the solid volume\n", k + 1, text_of(recipe.levels[k]),
                             100.0 * recipe.levels[k].share);
  Findings variants;  // a dozen lines for every packing: their number is enough here
  check_variants(recipe.material, variants, false);
  for (const std::string& raised : recipe.raised) out.lines += "  " + raised + "\n";
  for (const std::string& doubt : recipe.doubts) out.warn(doubt);
  const auto packings = std::count_if(recipe.material.variants.begin(), recipe.material.variants.end(),
                                      [](const MaterialVariant& v) { return !v.same_packings; });
  out.add("packings", packings,
          fmt::format("{} different packings are measured, {} samples of each", packings,
                      recipe.material.variants.front().setup.samples));
  if (recipe.checked)
    out.add("checked_levels", recipe.checked_levels,
            fmt::format("the {} coarsest levels are checked with all their grains, {} a sample", recipe.checked_levels,
                        recipe.check.grains));
  out.lines += "  " + stress_line(recipe.material.variants.front().setup.spec) + "\n";
  const auto grains = static_cast<double>(recipe.material.variants.front().setup.spec.bodies);
  double fewest = kFewGrains;
  std::size_t few = 0;
  for (std::size_t k = 0; k + 1 < recipe.levels.size(); ++k) {
    const double share = recipe.mixtures.back();
    const double coarse = (1.0 - share) / mean_grain_volume(recipe.levels[k].pieces);
    const double fine = share / mean_grain_volume(recipe.levels[k + 1].pieces);
    const double there = grains * coarse / (coarse + fine);
    few += there < kFewGrains ? 1 : 0;
    fewest = std::min(fewest, there);
  }
  if (few > 0)
    out.warn(
        fmt::format("{} of {} pairs of levels: a mixture has fewer than {:g} coarse grains (the least about {:.0f}): "
                    "its onset will scatter",
                    few, recipe.levels.size() - 1, kFewGrains, fewest));
  if (recipe.material.variants.front().setup.samples < 2)
    out.warn(recipe.checked && recipe.check.samples > 1
                 ? "one sample of each packing: all errors of the law come from the scatter of the check alone"
                 : "one sample: the law will have no errors");
  if (recipe.checked_levels < 2) out.warn("nothing is checked with all its grains: more of them ([check] grains)");
  if (recipe.checked && !tells_ways(recipe)) out.warn(kTwoLevelsTellNothing);
  out.spend("packings", packing_seconds(recipe));
  out.spend("friction of cells", friction_seconds(recipe.cells));
  if (recipe.shells.levels > 0)
    out.spend("shells", 10.0 * static_cast<double>(recipe.shells.levels * recipe.shells.packings));
}

}  // namespace softgrain
