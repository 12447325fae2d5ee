// How the forces on the sites of cells answer small motions, and the motion that would bring them to rest.
#pragma once

#include <vector>

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

}  // namespace softgrain
