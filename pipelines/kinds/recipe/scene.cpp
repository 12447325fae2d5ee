#include "pipelines/kinds/recipe/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/packing/grading.h"
#include "common/packing/grading_scene.h"
#include "macrosim/grain_materials.h"
#include "pipelines/kinds/macro/stages.h"
#include "pipelines/kinds/material/run.h"
#include "pipelines/kinds/recipe/run.h"
#include "pipelines/kinds/recipe/stages.h"
#include "pipelines/kinds/soft_particle/snapshot_recorder.h"

namespace softgrain {

namespace {

/// A mixture with fewer coarse or fine grains than this tells nothing.
constexpr double kLeastGrains = 8.0;
/// Least volume of a level, of all.
constexpr double kLeastShare = 0.005;
/// A sample should have so many grains above a third of the largest radius.
constexpr double kCoarseGrains = 60.0;

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

/// Levels that hold something, and neighbours that a packing can hold together.
void require_levels(const SceneTable& t, const RecipeScene& scene, std::int64_t grains) {
  const auto& levels = scene.levels;
  if (levels.size() < 2)
    t.throw_error("ratio",
                  fmt::format("the sizes make one level ({}): resolve all grains, with kind = \"material\", or cut "
                              "closer",
                              level_text(levels.front())));
  for (std::size_t k = 0; k < levels.size(); ++k)
    if (levels[k].share < kLeastShare)
      t.add_error("cut_diameters",
                  fmt::format("level {} ({}) holds {:.2g} % of the volume; {:g} % at least: cut elsewhere", k + 1,
                              level_text(levels[k]), 100.0 * levels[k].share, 100.0 * kLeastShare));
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
                      k + 1, k + 2, level_text(levels[k]), level_text(levels[k + 1]), grains, share, least,
                      coarse < fine ? "coarse" : "fine"));
      break;
    }
}

/// Stresses that a test goes to or that are read from it, times a factor.
void scale_stresses(MacroSpec& spec, double factor) {
  for (double& stress : spec.modulus_stress) stress *= factor;
  for (MacroStage& stage : spec.stages) {
    for (AxisDrive& axis : stage.axis)
      if (axis.to_stress()) axis.value *= factor;
    for (double& stress : stage.record.modulus_stress) stress *= factor;
  }
}

MaterialVariant variant_of(const std::string& name, const MacroSetup& base, const Grading& sizes) {
  MaterialVariant v{name, base};
  take_sizes(v.setup.spec, sizes);
  take_own_reference(v.setup.spec, sizes);
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
  // Read even without a check, so that --set check.grains=0 alone switches it off.
  out.check.samples =
      check.count({"samples", "samples of the check; without a check they do not count"}, 1, 1000, out.check.samples);
  const SceneTable macro = root.table_or_empty({"macro", "level 1, which is loaded with the cell law"});
  out.macro.grains =
      macro.count({"grains", "grains of level 1, which is loaded with the cell law"}, 40, 100000, out.macro.grains);
  out.macro.samples =
      macro.count({"samples", "samples of level 1, which is loaded with the cell law"}, 1, 1000, out.macro.samples);
  out.macro.strain = macro.number(
      {"strain", "axial strain of the loading of level 1", "that of the test, or half of the porosity if that is less"},
      Unit::none, Range::closed(kLeastStrain, 0.5), out.macro.strain);
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

}  // namespace

void take_own_reference(MacroSpec& spec, const Grading& sizes) {
  if (spec.grain_materials.empty()) return;
  const double before = spec.youngs_modulus;
  take_reference(spec, sizes);
  scale_stresses(spec, spec.youngs_modulus / before);
}

MacroSpec test_of_whole(MacroSpec spec, double youngs_modulus) {
  if (spec.youngs_modulus == youngs_modulus) return spec;
  scale_stresses(spec, youngs_modulus / spec.youngs_modulus);
  spec.youngs_modulus = youngs_modulus;
  return spec;
}

std::string level_text(const RecipeLevel& level) {
  return fmt::format("diameters {:.3g} to {:.3g} mm", 2e3 * level.low, 2e3 * level.high);
}

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
    out.material.title = root.title();
    out.material.seed = static_cast<std::uint64_t>(root.count(kSeedKey, 0, 1000000000000, 1));
    MacroSetup base = recipe_defaults();
    const bool modulus_is_known = read_material_tables(root, base, &out.constituents);
    out.youngs_modulus = base.spec.youngs_modulus;
    root.table_or_empty("packing").refuse(kDensityKeys,
                                          "the packings that are measured differ in density, by their sizes: give "
                                          "preparation or compaction_mu; a target goes with kind = \"material\"");
    const SceneTable grains = root.table("grains");
    if (base.spec.test != MacroTest::oedometric)
      root.table("test").add_error("test", "levels are measured in oedometric compression (and one of them in shear)");
    read_recipe_stages(root, base.spec, modulus_is_known);
    base.samples = root.count({"samples", "samples of each packing"}, 1, 10000, base.samples);
    base.kept_states = read_kept_states(root, 0);
    const double shear =
        read_law(root.table_or_empty({"law", "fits of the equation of state and of the cell law"}), out);
    read_rest(root, out);
    if (root.has("shells") && base.spec.rolling.friction > 0.0)
      root.add_error("shells", "goes without mu_r: soft particles are measured with grains that roll freely");
    if (root.has("shells") && !base.spec.grain_materials.empty())
      root.add_error("shells",
                     "goes without E, nu and mu of [[constituent]]: soft particles hold grains of one material");
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
    require_room(root, out);
    for (std::size_t v = 0; v < out.material.variants.size(); ++v)
      require_material_memory(out.checked == v ? root.table_or_empty("check") : grains, out.material.variants[v].setup);
    return out;
  });
}

}  // namespace softgrain
