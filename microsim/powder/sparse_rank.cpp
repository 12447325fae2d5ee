#include "microsim/powder/sparse_rank.h"

#include <algorithm>
#include <cmath>

#include "microsim/powder/sparse_qr.h"

namespace softgrain {

namespace {

using Entry = SparseEntries::Entry;

void to_unit_length(SparseEntries& matrix, std::int64_t Entry::*line, std::int64_t lines) {
  std::vector<double> square(static_cast<std::size_t>(lines), 0.0);
  for (const Entry& e : matrix.entries) square[static_cast<std::size_t>(e.*line)] += e.value * e.value;
  for (Entry& e : matrix.entries) e.value /= std::sqrt(square[static_cast<std::size_t>(e.*line)]);
}

struct SingularPair {
  double value = 0.0;
  std::vector<double> vector;
};

/// Smallest singular value of R by inverse iteration on R^T R: from above, at once when it is far below the others.
SingularPair smallest_singular(const TriangularFactor& factor) {
  constexpr int kIterations = 20;
  SingularPair out;
  for (std::int64_t k = 0; k < factor.rank; ++k) out.vector.push_back(std::sin(static_cast<double>(k) + 1.0));
  for (int iteration = 0; iteration <= kIterations; ++iteration) {
    double square = 0.0;
    for (const double x : out.vector) square += x * x;
    const double size = std::sqrt(square);
    for (double& x : out.vector) x /= size;
    if (iteration > 0) out.value = 1.0 / std::sqrt(size);
    if (iteration < kIterations) factor.solve_normal(out.vector);
  }
  return out;
}

void take_out(SparseEntries& matrix, std::int64_t column) {
  std::erase_if(matrix.entries, [&](const Entry& e) { return e.column == column; });
}

}  // namespace

SparseRank sparse_rank(const SparseEntries& matrix) {
  SparseEntries scaled = matrix;
  to_unit_length(scaled, &Entry::row, matrix.rows);
  to_unit_length(scaled, &Entry::column, matrix.columns);
  SparseRank out;
  while (!scaled.entries.empty()) {
    const TriangularFactor factor = sparse_qr(scaled, kRankTolerance);
    const SingularPair smallest = smallest_singular(factor);
    ++out.factorisations;
    out.rank = factor.rank;
    out.smallest_kept = smallest.value;
    out.largest_dropped = std::max(out.largest_dropped, factor.dropped);
    if (smallest.value >= kRankTolerance) break;
    out.largest_dropped = std::max(out.largest_dropped, smallest.value);
    const auto most = std::max_element(smallest.vector.begin(), smallest.vector.end(),
                                       [](double a, double b) { return std::abs(a) < std::abs(b); });
    take_out(scaled, factor.column_of[static_cast<std::size_t>(most - smallest.vector.begin())]);
  }
  return out;
}

}  // namespace softgrain
