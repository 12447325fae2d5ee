// Where the particles of a scene are at its start: particles that no wall or cell holds are found before anything runs.
#pragma once

#include <string>
#include <vector>

#include "common/system.h"
#include "microsim/particles/guards.h"
#include "microsim/particles/scene_bodies.h"

namespace softgrain {

/// Throws InputError with file:line for a particle whose centre is behind a plane or outside the room of guards.escape,
/// where that guard would stop the run at its first look; where the guard only counts, this is a remark. Remarks also
/// name particles outside of all insides of spheres (unless they say inside = "none") and centres outside a cell along
/// an axis that is not periodic. `has_cell`: the scene says a cell. Each remark names the first particle and their
/// number.
template <int D>
std::vector<std::string> place_remarks(const SceneBodies<D>& bodies, const System<D>& system,
                                       const std::vector<std::string>& wall_name, const GuardSpec& guards,
                                       bool has_cell);

}  // namespace softgrain
