// Parts of a run of a recipe.
#pragma once

#include <string>
#include <vector>

#include "common/data/law_card.h"
#include "common/data/multi_contact_law.h"
#include "pipelines/kinds/recipe/scene.h"
#include "pipelines/kinds/recipe/summary.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/run/findings.h"
#include "pipelines/run/run.h"

namespace softgrain {

inline constexpr const char* kMaterialCardFile = "material_card.toml";

/// Whether the check tells which way of joining levels does better: it holds a level more than the mixtures of two that
/// both were fitted to, or it is the whole itself.
bool tells_ways(const RecipeScene& scene);
inline constexpr const char* kTwoLevelsTellNothing =
    "a check of two levels lies between mixtures that were measured, to which both ways of joining levels are fitted: "
    "it "
    "cannot tell which way does better over more levels, and the value is the middle of both; more grains ([check] "
    "grains) check three levels";

/// Levels, packings, time, and what to mind. Throws InputError, IoError.
void check_recipe(const RecipeScene& recipe, Findings& out);

KindResults recipe_results();

/// What a run says in the terminal.
std::string console_summary(const RecipeSummary& summary);

/// "544 (480 to 610)", times `unit`; measured values behind it.
std::string value_text(const PredictedValue& v, double unit);

namespace report {
std::string recipe_section(const RunData& run);
}

// The coarsest level of a recipe under load: in cells of everything finer, and with soft particles in its place.

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

// The hierarchy of soft particles of a recipe: decade by decade from the finest, each in the voids of the next.

struct ShellLevels {
  std::vector<ShellLevelSummary> levels;  ///< the finest first
  LawTable table;                         ///< law table of the coarsest level
  std::vector<std::string> remarks;
  bool usable = true;  ///< every level has a good law
};

/// Measures and fits all levels, each with its slice of the curve; writes law_table_level_K.toml,
/// multi_contact_level_K.h5 and law_table.toml. Throws UnusableResult when a level has no law.
ShellLevels run_shells(const RecipeScene& scene, const Run& run);

}  // namespace softgrain
