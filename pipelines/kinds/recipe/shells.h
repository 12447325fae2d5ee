// The hierarchy of soft particles of a recipe: decade by decade from the finest, each in the voids of the next.
#pragma once

#include <vector>

#include "common/data/multi_contact_law.h"
#include "pipelines/kinds/recipe/scene.h"
#include "pipelines/kinds/recipe/summary.h"
#include "pipelines/run/run.h"

namespace softgrain {

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
