#include "microsim/powder/powder_stiffness.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

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

}  // namespace

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

}  // namespace softgrain
