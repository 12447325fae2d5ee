// Rattlers, grains that carry next to nothing, relaxed one by one: their contacts open, close and slide for many steps
// that the rest of the pack does not need.
#pragma once

#include "common/statics/pack_problem.h"

namespace softgrain::statics {

/// Moves every grain that carries less than `least_force` [N] and whose residual is above `tolerance` (of
/// `least_force`) towards its own balance, the others held, one after the other in ascending order. `forces`: those at
/// theta; they are out of date when the call returns true.
bool relax_rattlers(PackProblem& problem, const PackForces& forces, double least_force, double tolerance,
                    Unknowns& theta);

}  // namespace softgrain::statics
