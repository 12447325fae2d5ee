// Sparse matrices as lists of entries, their QR factorisation with SuiteSparseQR, and their rank by factorisations that
// are checked for what they may have missed.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace softgrain {

/// A sparse matrix with at most one entry per place.
struct SparseEntries {
  struct Entry {
    std::int64_t row = 0;
    std::int64_t column = 0;
    double value = 0.0;
  };
  std::int64_t rows = 0;
  std::int64_t columns = 0;
  std::vector<Entry> entries;

  [[nodiscard]] SparseEntries transposed() const {
    SparseEntries out = *this;
    std::swap(out.rows, out.columns);
    for (Entry& e : out.entries) std::swap(e.row, e.column);
    return out;
  }
};

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

/// What was found, and how clear the decision was.
struct SparseRank {
  std::int64_t rank = 0;
  double smallest_kept = 0.0;    ///< smallest singular value of the independent columns (estimate); 0: rank 0
  double largest_dropped = 0.0;  ///< Frobenius norm of all that was taken for zero
  int factorisations = 0;
};

/// Singular values of the scaled matrix below this count as zero.
inline constexpr double kRankTolerance = 1e-10;

/// Rows are scaled to unit length, then columns (neither changes the rank). Heath's rule alone keeps a dependent column
/// now and then, when rounding has grown along a chain of nearly dependent ones; so inverse iteration looks for a small
/// singular value of the factor, and while there is one, the column that counts most in its vector is taken out, which
/// leaves the rank as it is, and the rest is factorised again.
SparseRank sparse_rank(const SparseEntries& matrix);

}  // namespace softgrain
