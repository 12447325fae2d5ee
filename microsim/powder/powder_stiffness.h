// Whether the springs of a powder hold it against every small motion [CP 3.5].
#pragma once

#include <optional>

#include "microsim/powder/rigidity_matrix.h"

namespace softgrain {

/// Definiteness of K = G^T k G, k diagonal: K_N, K_T, K_r of contacts, -F0/D0 of distant pairs.
struct Definiteness {
  bool positive = false;
  /// Smallest pivot of K scaled to a unit diagonal; none when the factorisation broke down.
  std::optional<double> smallest_pivot;
};

/// Smaller pivots of K (unit diagonal) count as zero.
inline constexpr double kPivotTolerance = 1e-12;

/// Sparse Cholesky of K with both displacements of one disk held, which takes away the two translations and nothing
/// else. Prestress is left out: forces that turn with their pairs add to K or take from it in the order of overlap over
/// size. Positive definite means rigid; the reverse holds only without distant pairs. False without disks.
Definiteness stiffness_definiteness(const RigidityMatrix& matrix);

}  // namespace softgrain
