// Parts of reading the scene of a recipe.
#pragma once

#include <string>
#include <vector>

#include "common/io/scene.h"
#include "pipelines/kinds/recipe/scene.h"

namespace softgrain {

/// All [[constituent]]; empty without any. `density`: of those that do not give their own [kg/m^3].
std::vector<Constituent> read_constituents(const SceneTable& root, double density);

/// Refuses the density of the material where every constituent gives its own.
void refuse_idle_density(const SceneTable& root);

/// Sizes of all constituents together, by solid volume.
Grading mixed_sizes(const std::vector<Constituent>& constituents);

/// Gives every packing room for the images of its largest grains: numbers that nobody asked for are raised. Those of
/// the scene are refused where grains cannot even be placed, and doubted where they may have no room when they are
/// pressed. Throws InputError.
void require_room(const SceneTable& root, RecipeScene& scene);

/// "diameters 1 to 3.2 mm".
std::string level_text(const RecipeLevel& level);

}  // namespace softgrain
