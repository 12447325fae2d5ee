// QR factorisation of a sparse matrix with SuiteSparseQR.
#pragma once

#include <cstdint>
#include <vector>

#include "microsim/powder/sparse_entries.h"

namespace softgrain {

/// The independent part of R in A P = Q R: upper triangular, rank x rank, by columns; the diagonal ends its column.
struct TriangularFactor {
  std::int64_t rank = 0;
  std::vector<std::int64_t> start;  ///< rank + 1 places in `row` and `value`
  std::vector<std::int64_t> row;
  std::vector<double> value;
  std::vector<std::int64_t> column_of;  ///< column of A, per column of the factor
  double dropped = 0.0;                 ///< Frobenius norm of what was set to zero: bounds singular value rank + 1 of A

  /// x <- (R^T R)^-1 x.
  void solve_normal(std::vector<double>& x) const;
};

/// Householder QR with an ordering that keeps R sparse. Heath's rule: a column whose part independent of the columns
/// before it is shorter than `tolerance` is left out of the factor. Throws std::runtime_error when memory runs out.
TriangularFactor sparse_qr(const SparseEntries& matrix, double tolerance);

}  // namespace softgrain
