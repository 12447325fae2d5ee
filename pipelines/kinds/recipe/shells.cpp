#include "pipelines/kinds/recipe/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/contact/make_laws.h"
#include "common/contact/multi_contact_prediction.h"
#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/packing/grading.h"
#include "pipelines/kinds/hierarchy/level.h"
#include "pipelines/kinds/law_table/multi_contact_summary.h"

namespace softgrain {

namespace {

/// Radius of the shell that is measured [m]; the largest grain is half of it.
constexpr double kShell = 0.016;

/// Decades of the curve, the coarsest first; those without a grain are passed over.
std::vector<RecipeLevel> decades_of(const RecipeScene& scene) {
  std::vector<double> cuts;
  for (std::int64_t k = 1; k < scene.shells.levels; ++k)
    cuts.push_back(scene.sizes.largest() * std::pow(scene.shells.ratio, -static_cast<double>(k)));
  std::vector<RecipeLevel> levels = levels_of(scene.sizes, cuts);
  // Of the last one, what is finer than a decade stays out: it would be too many grains for a shell.
  const double floor = levels.back().high / scene.shells.ratio;
  const std::vector<SizePiece> kept = pieces_between(Grading::classes(levels.back().pieces), floor, kInfinity);
  if (levels.back().low < floor && !kept.empty()) {
    levels.back().pieces = kept;
    levels.back().low = floor;
  }
  return levels;
}

std::string sizes_text_of(const RecipeLevel& level) {
  std::string text = "[packing.sizes]\nform = \"classes\"\n";
  double all = 0.0;
  for (const SizePiece& p : level.pieces) all += p.volume;
  const double unit = 0.5 * kShell / level.high;
  for (const SizePiece& p : level.pieces) {
    text += fmt::format("[[packing.sizes.class]]\nvolume_share = {}\n", p.volume / all);
    text += p.low == p.high ? fmt::format("radius = {}\n", p.low * unit)
                            : fmt::format("radius_min = {}\nradius_max = {}\nexponent = {}\n", p.low * unit,
                                          p.high * unit, p.exponent);
  }
  return text;
}

/// What a level measures, as a scene of kind "hierarchy" says it: planes alone and all around, a solid and a soft
/// neighbour. `finer`: the next level, none for the finest.
HierarchySetup setup_of(const RecipeScene& scene, const RecipeLevel& level, const RecipeLevel* finer) {
  const MacroSpec& spec = scene.material.variants.front().setup.spec;
  const double hole = std::min(0.2, 1.0 / scene.shells.ratio);
  std::string text = fmt::format(
      "kind = \"hierarchy\"\nseed = {}\n[material]\nE = {}\nnu = {}\nmu = {}\ndensity = {}\n[packing]\nshell_radius = "
      "{}\nbeta = 3.0\ntrials = 10000\nplacement = \"voids\"\n{}[hierarchy]\nlevels = 2\nform = \"{}\"\n"
      "inner_radius = {}\ninner_radius_min = {}\nnext_volume = {}\nreplicates = 0\n[multi_contact]\nincrement = "
      "0.005\ntolerance = 1e-2\npackings_min = "
      "{}\npackings_max = {}\n"
      "target = 0.05\npoints = 10\n",
      scene.material.seed, spec.youngs_modulus, spec.poisson_ratio, spec.friction, spec.density, kShell,
      sizes_text_of(level), to_string(scene.shells.form), hole, 0.5 * hole,
      finer != nullptr ? finer->share / level.share : 1.0, scene.shells.packings, scene.shells.packings);
  const auto add = [&](const char* arrangement, const char* partner, double overlap) {
    text += fmt::format("[[configuration]]\narrangement = \"{}\"\npartner = \"{}\"\noverlap = {}\n{}", arrangement,
                        partner, overlap, std::string(partner) == "plane" ? "" : "ratio = 1.0\n");
  };
  add("one", "plane", 0.30);
  add("cube", "plane", 0.20);
  add("one", "solid", 0.32);
  add("one", "soft", 0.40);
  return read_hierarchy_setup(Scene::parse(text, "shells of the recipe"));
}

double force_of_plane(const LawTableEntry& entry, LawForm form) {
  const MultiContactLaw* law = entry.find(form);
  if (law == nullptr) return 0.0;
  MultiContactPartner plane;
  plane.direction[2] = 1.0;
  return multi_contact_forces(multi_contact_model(*law), {plane}, {0.2})[0];
}

}  // namespace

ShellLevels run_shells(const RecipeScene& scene, const Run& run) {
  const std::vector<RecipeLevel> decades = decades_of(scene);
  ShellLevels out;
  std::vector<HierarchyLevel> levels;
  MultiContactMeasurements below;
  for (std::size_t k = 0; k < decades.size(); ++k) {
    const RecipeLevel& decade = decades[decades.size() - 1 - k];
    run.context.say(fmt::format("shells, level {} of {}", k + 1, decades.size()));
    const HierarchySetup setup = setup_of(scene, decade, k > 0 ? &decades[decades.size() - k] : nullptr);
    LevelContents contents(setup, run.seed);
    MultiContactMeasurements data;
    HierarchyLevel level = run_level(setup, contents, static_cast<std::int64_t>(k),
                                     levels.empty() ? nullptr : &levels.back(), &below, data, run);
    for (const std::string& text : level.left_out) out.remarks.push_back(fmt::format("shells, level {}: {}", k, text));
    const MultiContactLaw* law = level.entry.find(scene.shells.form);
    if (law == nullptr || law->status == LawStatus::no_threshold_crossing)
      throw UnusableResult(fmt::format("shells, level {}: its law never crosses its threshold", k));
    if (law->status != LawStatus::good) {
      out.usable = false;
      out.remarks.push_back(fmt::format("shells, level {}: {}: {}", k, to_string(law->status), law->reason));
    }
    save_law_table({1, {level.entry}}, run.path(fmt::format("law_table_level_{}.toml", k)), run.provenance);
    out.levels.push_back({static_cast<std::int64_t>(k), 2.0 * decade.low, 2.0 * decade.high,
                          force_of_plane(level.entry, scene.shells.form), level.grains});
    levels.push_back(std::move(level));
    below = std::move(data);
  }
  out.table = {1, {levels.back().entry}};
  save_law_table(out.table, run.path("law_table.toml"), run.provenance);
  return out;
}

}  // namespace softgrain
