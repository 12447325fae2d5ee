// What `softgrain check` says of a recipe.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/text.h"
#include "macrosim/test_protocol.h"
#include "pipelines/kinds/material/run.h"
#include "pipelines/kinds/material_law/fines_in_cells.h"
#include "pipelines/kinds/recipe/law.h"
#include "pipelines/kinds/recipe/run.h"
#include "pipelines/kinds/recipe/stages.h"

namespace softgrain {

namespace {

/// With fewer coarse or fine grains than this a mixture scatters.
constexpr double kFewGrains = 30.0;

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

/// Warns of mixtures with few grains.
void judge_mixtures(const RecipeScene& recipe, Findings& out) {
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
                    "its onset will scatter; take more grains ([grains] count)",
                    few, recipe.levels.size() - 1, kFewGrains, fewest));
}

}  // namespace

void check_recipe(const RecipeScene& recipe, Findings& out) {
  out.warn_of_metres("the largest grain", recipe.sizes.largest());
  out.warn_of_grains(recipe.youngs_modulus, grain_density(recipe));
  for (const Constituent& c : recipe.constituents)
    out.lines += fmt::format("  {}: {:.3g} % of the mass, {:.3g} % of the solid volume\n", c.name, 100.0 * c.mass_share,
                             100.0 * c.volume_share);
  for (std::size_t k = 0; k < recipe.levels.size(); ++k)
    out.lines += fmt::format("  level {}: {}, {:.3g} % of the solid volume\n", k + 1, level_text(recipe.levels[k]),
                             100.0 * recipe.levels[k].share);
  const MacroSpec whole = test_of_whole(recipe.material.variants.front().setup.spec, recipe.youngs_modulus);
  if (const std::string text = materials_text(whole.grain_materials, whole.youngs_modulus); !text.empty())
    out.add("E", whole.youngs_modulus, text);
  Findings variants;  // a dozen lines for every packing: their number is enough here
  check_variants(recipe.material, variants, false);
  for (const std::string& raised : recipe.raised) out.lines += "  " + raised + "\n";
  for (const std::string& doubt : recipe.doubts) out.warn(doubt);
  const auto packings = std::count_if(recipe.material.variants.begin(), recipe.material.variants.end(),
                                      [](const MaterialVariant& v) { return !v.same_packings; });
  out.add("packings", packings,
          fmt::format("{} are measured, {} of each", counted(packings, "different packing"),
                      counted(recipe.material.variants.front().setup.samples, "sample")));
  if (recipe.checked)
    out.add("checked_levels", recipe.checked_levels,
            fmt::format("the {} coarsest levels are checked with all their grains, {} a sample", recipe.checked_levels,
                        recipe.check.grains));
  out.lines += "  " + stress_line(whole) + "\n";
  judge_mixtures(recipe, out);
  if (recipe.material.variants.front().setup.samples < 2)
    out.warn(recipe.checked && recipe.check.samples > 1
                 ? "one sample of each packing: all errors of the law come from the scatter of the check alone"
                 : "one sample: the law will have no errors");
  if (recipe.checked_levels < 2)
    out.warn(fmt::format("no packing with all grains of two levels checks the law: [check] grains = {} is too few",
                         recipe.check.grains));
  if (recipe.checked && !tells_ways(recipe)) out.warn(kTwoLevelsTellNothing);
  out.spend("packings", packing_seconds(recipe));
  out.spend("friction of cells", friction_seconds(recipe.cells));
  if (recipe.shells.levels > 0)
    out.spend("shells", 10.0 * static_cast<double>(recipe.shells.levels * recipe.shells.packings));
}

}  // namespace softgrain
