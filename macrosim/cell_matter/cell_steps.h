// How the forces on the sites of cells answer small motions, the motion that would bring them to rest, and Anderson's
// mixing of such steps [Walker and Ni 2011, SIAM J. Numer. Anal. 49, 1715].
#pragma once

#include <cstddef>
#include <deque>
#include <vector>

#include "common/core/vec.h"
#include "macrosim/cell_matter/cell_forces.h"

namespace softgrain {

/// The tangent of one state, applied without being put together:
///   H u = sum over cells of (-dp/dV) g_c (g_c . u) + sum over faces of k_f (u_j - u_i), g_c = dV_c/dx,
/// k_f in the plane of the face the tangent of its spring (a sliding one answers across its force alone, by the share
/// that the limit leaves), and in all directions kTurn |p_i - p_j| A/d for the turning of a face under different
/// pressures. What is left out - second derivatives of the volumes beyond that, limits that follow the pressure -
/// makes H symmetric and never negative, and costs iterations, not accuracy.
class CellTangent {
 public:
  /// References are kept.
  CellTangent(const std::vector<Sphere<3>>& sites, const RadicalCells& cells, const CellForces& forces);

  /// u with H u = forces, by conjugate gradients with the diagonal blocks as preconditioner, to `tolerance` of the
  /// forces. Deterministic: one thread.
  [[nodiscard]] std::vector<Vec3> answer(double tolerance, int most) const;

 private:
  struct Face {
    std::size_t i;
    std::size_t j;
    Vec3 upper;      ///< dV_i/dx_j
    Vec3 lower;      ///< dV_j/dx_i
    Matrix<3> pull;  ///< k_f
  };

  void find_diagonal();
  void apply(const std::vector<Vec3>& u, std::vector<double>& pressed, std::vector<Vec3>& out) const;

  const std::vector<Vec3>* force_;
  std::vector<Face> faces_;
  std::vector<double> stiffness_;   ///< -dp/dV of cells
  std::vector<Matrix<3>> inverse_;  ///< inverses of the diagonal blocks
  std::vector<Vec3> own_;           ///< dV_i/dx_i
  double ridge_ = 0.0;
};

/// An iteration x -> x + f(x) whose f goes to zero. mix() makes of f and what the last steps did to it the step that
/// would bring f nearest to zero, were it linear: least squares over the last `depth` differences.
class StepMixer {
 public:
  explicit StepMixer(std::size_t depth) : depth_(depth) {}

  /// f at the present place; the step from here. What is done with it is said to took().
  std::vector<Vec3> mix(const std::vector<Vec3>& f);
  void took(const std::vector<Vec3>& step) { step_ = step; }
  void forget();

 private:
  std::size_t depth_;
  std::vector<Vec3> f_;
  std::vector<Vec3> step_;
  std::deque<std::vector<Vec3>> changes_;  ///< changes of f in the last steps
  std::deque<std::vector<Vec3>> steps_;    ///< steps that caused these changes
};

}  // namespace softgrain
