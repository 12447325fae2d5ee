// Preconditioned iterative solutions of linear systems; operators are given as functions.
#pragma once

#include <cstdint>
#include <functional>

#include "common/statics/pack_problem.h"

namespace softgrain::statics {

using LinearMap = std::function<void(const Unknowns& in, Unknowns& out)>;

struct KrylovResult {
  std::int64_t iterations = 0;
  double reduction = 1.0;   ///< of the residual norm
  bool indefinite = false;  ///< conjugate gradient met a direction without stiffness and stopped before it
};

/// Preconditioned conjugate gradient for symmetric maps; x starts at zero.
KrylovResult conjugate_gradient(const LinearMap& map, const LinearMap& inverse, const Unknowns& rhs, double reduction,
                                std::int64_t most, Unknowns& x);

/// Stabilised biconjugate gradient (van der Vorst 1992, preconditioned from the right) for any map; x starts at zero.
/// `iterations` counts applications of the map, two per step.
KrylovResult biconjugate_gradient(const LinearMap& map, const LinearMap& inverse, const Unknowns& rhs, double reduction,
                                  std::int64_t most, Unknowns& x);

}  // namespace softgrain::statics
