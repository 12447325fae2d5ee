// The linearised forces of a pack as an operator on displacements, contact by contact; nothing is assembled.
#pragma once

#include "common/statics/pack_problem.h"

namespace softgrain::statics {

/// How contacts that slide enter: with their symmetric secant stiffness, or exactly.
enum class Sliding { secant, exact };

/// out = K in, K = -d(force)/d(theta) of the linearised contacts. The negative stiffness of normal forces that turn
/// with their pair, -P/|r_ij| T, is left out: K then never is negative, and what is left out is smaller than the rest
/// by the order of the overlap over the radius. With Sliding::exact K is not symmetric.
class Stiffness {
 public:
  Stiffness(const PackProblem& problem, const std::vector<LinkTangent>& tangents, Sliding sliding = Sliding::secant);
  void apply(const Unknowns& in, Unknowns& out) const;

 private:
  const PackProblem& problem_;
  const std::vector<LinkTangent>& tangents_;
  Sliding sliding_;
};

}  // namespace softgrain::statics
