// Rank of a sparse matrix by QR factorisations that are checked for what they may have missed.
#pragma once

#include <cstdint>

#include "microsim/powder/sparse_entries.h"

namespace softgrain {

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
