// Rattlers, grains that carry next to nothing, relaxed one by one: their contacts open, close and slide for many steps
// that the rest of the pack does not need.
#pragma once

#include "common/statics/pack_problem.h"

namespace softgrain::statics {

/// Moves grains towards their own balance, the others held, one after the other in ascending order: those that carry
/// next to nothing (less than ten times `least_force` [N]), and those whose net force stands out from all others', when
/// their residual is above `tolerance` (of their largest contact force, or of `least_force`). `forces`: those at theta;
/// they are out of date when the call returns true. Does nothing between symmetry planes.
bool relax_rattlers(PackProblem& problem, const PackForces& forces, double least_force, double tolerance,
                    Unknowns& theta);

}  // namespace softgrain::statics
