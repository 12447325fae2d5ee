// The linearised forces of a pack as an operator on displacements, contact by contact, nothing assembled;
// and the inverse of every grain's own block of it.
#pragma once

#include "common/statics/pack_problem.h"

namespace softgrain::statics {

/// How contacts that slide enter: with their symmetric secant stiffness, or exactly.
enum class Sliding { secant, exact };

/// out = K in, K = -d(force)/d(theta) of the linearised contacts [QS 2.1-2.2]; displacements [m] give forces [N]. The
/// negative stiffness of normal forces that turn with their pair, -P/|r_ij| T, is left out: K then never is negative,
/// and what is left out is smaller than the rest by the order of the overlap over the radius. With Sliding::exact K is
/// not symmetric.
class Stiffness {
 public:
  Stiffness(const PackProblem& problem, const std::vector<LinkTangent>& tangents, Sliding sliding = Sliding::secant);
  void apply(const Unknowns& in, Unknowns& out) const;

 private:
  const PackProblem& problem_;
  const std::vector<LinkTangent>& tangents_;
  Sliding sliding_;
};

/// A preconditioner: one symmetric positive block per grain, the inverse of its own contact stiffness. Rows of a grain
/// without stiffness get the mean of the pack.
class BlockJacobi {
 public:
  /// `tangents`: symmetric ones. `floor`: added to every diagonal entry, in the largest diagonal entry of the block;
  /// keeps free turns in place.
  void build(const PackProblem& problem, const std::vector<LinkTangent>& tangents, double floor);
  /// out = inverse * in
  void apply(const Unknowns& in, Unknowns& out) const;

  /// Largest diagonal entry of its grain's own stiffness, per unknown [N/m].
  [[nodiscard]] Unknowns stiffness() const;
  /// out += share * (largest diagonal entry of the grain's own stiffness) * in
  void add_diagonal(const Unknowns& in, double share, Unknowns& out) const;

 private:
  int width_ = 6;
  std::vector<double> largest_;  ///< per grain, largest diagonal entry
  std::vector<double> inverse_;  ///< per grain, width x width
};

/// The step of grain g alone that its own stiffness calls for; zero without contacts. `floor` as in build().
void own_step(const PackProblem& problem, std::size_t g, const GrainForces& grain, double floor, Unknowns& step);

}  // namespace softgrain::statics
