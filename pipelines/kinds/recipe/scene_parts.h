// Parts of reading the scene of a recipe.
#pragma once

#include <string>
#include <vector>

#include "common/io/scene.h"
#include "pipelines/kinds/recipe/scene.h"

namespace softgrain {

/// Makes E and density of a packing those of its own grains (take_reference), and multiplies the stresses of its test
/// with the change of E: packings of stiff grains and of soft ones are compared at equal stresses over E.
void take_own_reference(MacroSpec& spec, const Grading& sizes);

/// The test of a packing as it is for the whole, of this E [Pa].
MacroSpec test_of_whole(MacroSpec spec, double youngs_modulus);

/// Gives every packing room for the images of its largest grains: numbers that nobody asked for are raised. Those of
/// the scene are refused where grains cannot even be placed, and doubted where they may have no room when they are
/// pressed. Throws InputError.
void require_room(const SceneTable& root, RecipeScene& scene);

/// "diameters 1 to 3.2 mm".
std::string level_text(const RecipeLevel& level);

}  // namespace softgrain
