// The linearised forces of a pack as an operator on displacements, contact by contact; nothing is assembled.
#pragma once

#include "common/statics/pack_problem.h"

namespace softgrain::statics {

/// out = K in, K = -d(force)/d(theta) of the linearised contacts. `prestress`: the share of the negative stiffness of
/// normal forces that turn with their pair, -P/|r_ij| T (1: the exact derivative of the normal forces).
class Stiffness {
 public:
  Stiffness(const PackProblem& problem, const std::vector<LinkTangent>& tangents, double prestress);
  void apply(const Unknowns& in, Unknowns& out) const;

 private:
  const PackProblem& problem_;
  const std::vector<LinkTangent>& tangents_;
  double prestress_;
};

}  // namespace softgrain::statics
