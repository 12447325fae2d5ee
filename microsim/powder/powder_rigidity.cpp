#include "microsim/powder/powder_rigidity.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "microsim/powder/powder_contacts.h"
#include "microsim/powder/rigidity_matrix.h"

namespace softgrain {

namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

/// First column of the disk with most entries: no rattler.
std::int64_t held_column(const RigidityMatrix& m) {
  std::vector<int> count(static_cast<std::size_t>(m.entries.columns), 0);
  for (const auto& e : m.entries.entries) ++count[static_cast<std::size_t>(e.column)];
  std::int64_t held = 0;
  for (std::int64_t c = 0; c < m.disk_columns; c += m.per_disk)
    if (count[static_cast<std::size_t>(c)] > count[static_cast<std::size_t>(held)]) held = c;
  return held;
}

/// G without the two columns that are held.
SparseMatrix held_matrix(const RigidityMatrix& m) {
  const std::int64_t held = held_column(m);
  std::vector<Eigen::Triplet<double>> list;
  for (const auto& e : m.entries.entries) {
    if (e.column == held || e.column == held + 1) continue;
    list.emplace_back(static_cast<int>(e.row), static_cast<int>(e.column < held ? e.column : e.column - 2), e.value);
  }
  SparseMatrix g(m.entries.rows, m.entries.columns - 2);
  g.setFromTriplets(list.begin(), list.end());
  return g;
}

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

Rigidity rigidity_of(const RigidityMatrix& matrix) {
  Rigidity out;
  out.freedoms = matrix.entries.columns;
  out.constraints = matrix.entries.rows;
  out.of_matrix = sparse_rank(matrix.entries);
  out.of_transpose = sparse_rank(matrix.entries.transposed());
  out.floppy = out.freedoms - out.of_matrix.rank;
  out.indeterminacy = out.constraints - out.of_transpose.rank;
  out.stiffness = stiffness_definiteness(matrix);
  return out;
}

PowderRigidity powder_rigidity(const System<2>& system, const std::vector<PowderInteraction>& pairs, bool cohesive) {
  const auto of = [&](const std::vector<bool>& keep, CellMotions cell) {
    return rigidity_of(rigidity_matrix(pairs, system, keep, cell));
  };
  PowderRigidity out;
  const bool has_cell = system.cell.any_periodic();
  std::vector<bool> keep(static_cast<std::size_t>(system.particles.grains), true);
  out.fixed = of(keep, CellMotions::none);
  if (has_cell) out.free = of(keep, CellMotions::lengths);
  if (cohesive) return out;
  keep = powder_rattlers(system);
  keep.flip();
  out.backbone = of(keep, CellMotions::none);
  if (has_cell) out.backbone_free = of(keep, CellMotions::lengths);
  return out;
}

Definiteness stiffness_definiteness(const RigidityMatrix& m) {
  Definiteness out;
  if (m.disk_columns == 0 || m.entries.rows == 0) return out;
  const SparseMatrix g = held_matrix(m);
  const Eigen::Map<const Eigen::VectorXd> k(m.stiffness.data(), static_cast<Eigen::Index>(m.stiffness.size()));
  const SparseMatrix gt = g.transpose();
  SparseMatrix stiffness = gt * k.asDiagonal() * g;
  const Eigen::VectorXd diagonal = stiffness.diagonal();
  if (diagonal.minCoeff() <= 0.0) return out;
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  stiffness = scale.asDiagonal() * stiffness * scale.asDiagonal();
  const Eigen::SimplicialLLT<SparseMatrix> factor(stiffness);
  if (factor.info() != Eigen::Success) return out;
  const SparseMatrix lower = factor.matrixL();
  const double smallest = lower.diagonal().minCoeff();
  out.smallest_pivot = smallest * smallest;
  out.positive = *out.smallest_pivot > kPivotTolerance;
  return out;
}

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
