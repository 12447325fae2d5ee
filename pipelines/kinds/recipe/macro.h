// The coarsest level of a recipe under load: in cells of everything finer, and with soft particles in its place.
#pragma once

#include <string>
#include <vector>

#include "common/data/law_card.h"
#include "pipelines/kinds/recipe/scene.h"
#include "pipelines/kinds/recipe/summary.h"
#include "pipelines/run/run.h"

namespace softgrain {

/// Means over usable samples, stresses over E, as far as the longest goes.
RecipeCurve mean_curve(const std::string& name, const std::vector<MacroCurve>& curves);

/// Oedometric compression to `strain` of [macro] samples with the cell law, means over them; the band by the ends of
/// e_J. All curves go to `file`.
RecipeCurve press_in_cells(const RecipeScene& scene, const CellCard& card, double strain, const Run& run,
                           std::vector<MacroCurve>& kept);

/// Oedometric compression of the grains of press_in_cells(), with the fines' volume in soft particles of a law table.
/// Their radii are from a fifth to three fifths of the largest grain. They are prepared together as macro scenes are,
/// which gives a denser or looser packing than that of the cells.
RecipeCurve press_with_shells(const RecipeScene& scene, const CellCard& card, const LawTable& table, double strain,
                              const Run& run, std::vector<MacroCurve>& kept);

}  // namespace softgrain
