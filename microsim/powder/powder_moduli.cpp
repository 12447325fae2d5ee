#include "microsim/powder/powder_moduli.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include "microsim/powder/rigidity_matrix.h"

namespace softgrain {

namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;

constexpr double kHold = 1e-9;  ///< springs of motions without stiffness, over the mean stiffness

/// Columns of the disks, and those of the three strains.
struct Split {
  SparseMatrix disks;
  Columns strains;
};

Split split(const RigidityMatrix& m) {
  std::vector<Eigen::Triplet<double>> list;
  Split out{{m.entries.rows, m.disk_columns}, Columns::Zero(m.entries.rows, 3)};
  for (const auto& e : m.entries.entries) {
    if (e.column < m.disk_columns)
      list.emplace_back(static_cast<int>(e.row), static_cast<int>(e.column), e.value);
    else
      out.strains(e.row, e.column - m.disk_columns) = e.value;
  }
  out.disks.setFromTriplets(list.begin(), list.end());
  return out;
}

/// A C; empty when the disks would move by themselves.
std::optional<Eigen::Matrix3d> condensed(const RigidityMatrix& m) {
  const Split g = split(m);
  const Eigen::Map<const Eigen::VectorXd> k(m.stiffness.data(), static_cast<Eigen::Index>(m.stiffness.size()));
  const SparseMatrix gt = g.disks.transpose();
  SparseMatrix uu = gt * k.asDiagonal() * g.disks;
  SparseMatrix hold(uu.rows(), uu.cols());
  hold.setIdentity();
  uu += hold * (kHold * uu.diagonal().mean());
  const Eigen::SimplicialLLT<SparseMatrix> factor(uu);
  if (factor.info() != Eigen::Success) return std::nullopt;
  const Columns weighed = k.asDiagonal() * g.strains;
  const Columns ue = gt * weighed;
  const Columns moved = factor.solve(ue);
  return Eigen::Matrix3d(g.strains.transpose() * weighed - ue.transpose() * moved);
}

}  // namespace

std::optional<PowderModuli> powder_moduli(const System<2>& system, const std::vector<PowderInteraction>& pairs) {
  if (!system.cell.any_periodic()) return std::nullopt;
  const std::vector<bool> all(static_cast<std::size_t>(system.particles.grains), true);
  RigidityMatrix m = rigidity_matrix(pairs, system, all, CellMotions::strain);
  if (m.contacts == 0) return std::nullopt;
  PowderModuli out;
  std::optional<Eigen::Matrix3d> c = condensed(m);
  if (!c) {
    out.distant = false;
    for (double& k : m.stiffness) k = std::max(k, 0.0);
    c = condensed(m);
  }
  if (!c) return std::nullopt;
  *c /= system.cell.volume();
  out.bulk = 0.25 * ((*c)(0, 0) + (*c)(1, 1) + 2.0 * (*c)(0, 1));
  out.shear_axes = 0.25 * ((*c)(0, 0) + (*c)(1, 1) - 2.0 * (*c)(0, 1));
  out.shear_cross = (*c)(2, 2);
  out.shear = 0.5 * (out.shear_axes + out.shear_cross);
  return out;
}

}  // namespace softgrain
