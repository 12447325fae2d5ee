// Preconditioner of one block per grain: the inverse of its own contact stiffness.
#pragma once

#include "common/statics/pack_problem.h"

namespace softgrain::statics {

/// Symmetric positive blocks, one Cholesky factor per grain. Rows of a grain without stiffness get the mean of the
/// pack.
class BlockJacobi {
 public:
  /// `tangents`: symmetric ones. `floor`: added to every diagonal entry, in the largest diagonal entry of the block;
  /// keeps free turns in place.
  void build(const PackProblem& problem, const std::vector<LinkTangent>& tangents, double floor);
  /// out = inverse * in
  void apply(const Unknowns& in, Unknowns& out) const;

  /// out += share * (largest diagonal entry of the grain's own stiffness) * in
  void add_diagonal(const Unknowns& in, double share, Unknowns& out) const;

 private:
  int width_ = 6;
  std::vector<double> largest_;  ///< per grain, largest diagonal entry
  std::vector<double> factor_;   ///< per grain, width x width, lower triangle, diagonal inverted
};

}  // namespace softgrain::statics
