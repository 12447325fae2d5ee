#include "pipelines/kinds/recipe/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/core/statistics.h"
#include "common/data/law_words.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/macro/stage.h"
#include "pipelines/kinds/material_models/models.h"
#include "pipelines/law/named_laws.h"
#include "pipelines/run/result_cache.h"

namespace softgrain {

namespace {

constexpr std::int64_t kSteps = 16;

/// The coarsest level at its own size, with the cells' law between: no contacts, whose materials would differ.
MacroSetup setup_of(const RecipeScene& scene, const CellCard& card, double strain) {
  MacroSetup setup = scene.material.variants.front().setup;
  MacroSpec& spec = setup.spec;
  spec = test_of_whole(std::move(spec), scene.youngs_modulus);
  take_sizes(spec, Grading::classes(scene.levels[0].pieces));
  spec.bodies = scene.macro.grains;
  spec.splits.clear();
  spec.test = MacroTest::oedometric;
  spec.stages.clear();
  spec.strain_end = strain;
  spec.steps = kSteps;
  spec.increments_per_step = 1;
  spec.cells = CellMatter{card, 1.0 - scene.levels[0].share, 0.0, false};
  setup.samples = scene.macro.samples;
  setup.kept_states = 0;
  return setup;
}

/// One curve of all samples; what cannot be run is said in it.
RecipeCurve pressed(const std::string& name, std::vector<MacroCurve>& kept,
                    const std::function<std::vector<MacroCurve>()>& run) {
  try {
    std::vector<MacroCurve> curves = run();
    for (MacroCurve& c : curves) c.engine = name;
    kept.insert(kept.end(), curves.begin(), curves.end());
    return mean_curve(name, curves);
  } catch (const UnusableResult& e) {
    return {name, {}, {}, {}, {}, {}, e.what()};
  } catch (const InputError& e) {
    return {name, {}, {}, {}, {}, {}, e.what()};
  }
}

RecipeCurve cells_curve(const RecipeScene& scene, const CellCard& card, double strain, const std::string& name,
                        const std::string& task, const Run& run, std::vector<MacroCurve>& kept) {
  return pressed(name, kept, [&] {
    const MacroSetup setup = setup_of(scene, card, strain);
    const std::vector<MacroPacking> packings = prepare_packings(setup, run, task + ".h5");
    return run_engines({setup, packings, {}, run.seed, task}, {}, run, "");
  });
}

}  // namespace

RecipeCurve mean_curve(const std::string& name, const std::vector<MacroCurve>& curves) {
  RecipeCurve out{name, {}, {}, {}, {}, {}, ""};
  const MacroCurve* longest = nullptr;
  for (const MacroCurve& c : curves)
    if (c.usable && (longest == nullptr || c.strain.size() > longest->strain.size())) longest = &c;
  for (const MacroCurve& c : curves)
    if (!c.usable) out.problem = c.note;
  if (longest == nullptr) return out;
  for (std::size_t k = 0; k < longest->strain.size(); ++k) {
    Tally axial;
    Tally lateral;
    for (const MacroCurve& c : curves) {
      if (!c.usable || k >= c.strain.size()) continue;
      axial.add(c.stress_axial[k] / c.start.youngs_modulus);
      lateral.add(c.stress_lateral[k] / c.start.youngs_modulus);
    }
    out.strain.push_back(longest->strain[k]);
    out.axial.push_back(axial.mean());
    out.lateral.push_back(lateral.mean());
  }
  return out;
}

RecipeCurve press_in_cells(const RecipeScene& scene, const CellCard& card, double strain, const Run& run,
                           std::vector<MacroCurve>& kept) {
  RecipeCurve out = cells_curve(scene, card, strain, "cell law", "cells", run, kept);
  if (!interval_known(card.void_ratio.low, card.void_ratio.high)) return out;
  CellCard low = card;
  low.void_ratio.value = card.void_ratio.high;  // looser fines bear less
  CellCard high = card;
  high.void_ratio.value = card.void_ratio.low;
  const RecipeCurve below = cells_curve(scene, low, strain, "cell law, low", "cells-low", run, kept);
  const RecipeCurve above = cells_curve(scene, high, strain, "cell law, high", "cells-high", run, kept);
  if (below.axial.size() != out.axial.size() || above.axial.size() != out.axial.size()) return out;
  for (std::size_t k = 0; k < out.axial.size(); ++k) {
    out.low.push_back(std::min({below.axial[k], above.axial[k], out.axial[k]}));
    out.high.push_back(std::max({below.axial[k], above.axial[k], out.axial[k]}));
  }
  return out;
}

RecipeCurve press_with_shells(const RecipeScene& scene, const CellCard& card, const LawTable& table, double strain,
                              const Run& run, std::vector<MacroCurve>& kept) {
  constexpr double kLow = 0.2;
  constexpr double kHigh = 0.6;
  return pressed("shell law", kept, [&] {
    MacroSetup setup = setup_of(scene, card, strain);
    const std::vector<MacroPacking> cells = prepare_packings(setup, run, "cells.h5");
    setup.spec.cells.reset();
    setup.spec.increments_per_step = scene.material.variants.front().setup.spec.increments_per_step;
    LawSources sources;
    sources.laws = {{table}};
    sources.forms = {scene.shells.form};
    const double inside = law_fraction(sources, 0.0) > 0.0 ? law_fraction(sources, 0.0) : 1.0;
    const double largest = scene.levels[0].high;
    const Grading shells = Grading::power_law(3.5, kLow * largest, kHigh * largest);
    std::vector<MacroPacking> packings;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      double coarse = 0.0;
      for (const MacroBody& b : cells[k].bodies) coarse += kSphereVolume * b.r * b.r * b.r;
      const double fines = coarse * fines_over_coarse(scene, 0) / inside;
      const std::string key =
          fmt::format("{}shells of a recipe, volume {:.17g}\n", packing_key(setup.spec, run.seed, k), fines);
      packings.push_back(kept_packing(key, SharedResults::name("recipe_shells", key), run, [&] {
        return pack_bodies(setup.spec, with_shells(cells[k].bodies, shells, fines, run.seed, k), run.seed, k);
      }));
      packings.back().springs.clear();
    }
    setup.spec.bodies = static_cast<std::int64_t>(packings.front().bodies.size());
    return run_engines({setup, packings, {}, run.seed, "shells"}, {scene_law(sources, setup.spec, inside, "shell law")},
                       run, "");
  });
}

}  // namespace softgrain
