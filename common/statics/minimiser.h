// The minimisers of an increment. Each starts from theta and leaves its answer there.
#pragma once

#include "common/statics/pack_problem.h"

namespace softgrain::statics {

/// Forces and lengths that a minimiser measures with.
struct Scales {
  double energy = 0.0;       ///< mean E times mean R^2 [N]
  double floor_force = 0.0;  ///< floor_force of worst_residual [N]
};
Scales scales_of(const GrainPack& pack, const LeastWorkOptions& options);

/// How well theta balances: the largest, over grains, of net force (or moment/R) over the grain's largest contact
/// force. `floor_force` [N] replaces smaller contact forces.
double worst_residual(const PackForces& forces, const GrainPack& pack, int stride, double floor_force);

/// floor_force with the mean contact force of the state.
double residual_floor(const Scales& scales, const PackForces& forces);

/// Displacement of every grain when the pack deforms evenly with its walls: between two opposite walls the normal part
/// of their moves is interpolated [QS 2.2, "2 x_l/L_l"], and so is the difference of their tangential parts.
Unknowns affine_guess(const PackProblem& problem, double part);

/// The multiple of `step` that moves the fastest grain by `limit` of its radius; infinity when nothing moves.
double longest_step(const Unknowns& step, const GrainPack& pack, int stride, double limit);

LeastWorkResult minimise_published(PackProblem& problem, Unknowns& theta, const LeastWorkOptions& options);
LeastWorkResult minimise_fast(PackProblem& problem, Unknowns& theta, const LeastWorkOptions& options);

/// Rattlers open, close and slide for many steps that the rest of the pack does not need: they are relaxed one by one.
/// Moves grains towards their own balance, the others held, one after the other in ascending order: those that carry
/// next to nothing (less than ten times `least_force` [N]), and those whose net force stands out from all others', when
/// their residual is above `tolerance` (of their largest contact force, or of `least_force`). `forces`: those at theta;
/// they are out of date when the call returns true. Does nothing between symmetry planes.
bool relax_rattlers(PackProblem& problem, const PackForces& forces, double least_force, double tolerance,
                    Unknowns& theta);

}  // namespace softgrain::statics
