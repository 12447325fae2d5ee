// Loops over bodies on several threads, in pieces of a fixed length: sums have the same bits for any number of threads.
#pragma once

#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace softgrain {

inline constexpr std::size_t kBodiesPerPiece = 2048;
/// Below this many bodies one thread is faster than two.
inline constexpr std::size_t kParallelBodies = 4000;

/// work(begin, end) for pieces of 0 .. bodies - 1.
template <class Work>
void over_bodies(std::size_t bodies, const Work& work) {
  const auto pieces = static_cast<std::int64_t>((bodies + kBodiesPerPiece - 1) / kBodiesPerPiece);
#pragma omp parallel for schedule(static) if (bodies >= kParallelBodies && omp_in_parallel() == 0)
  for (std::int64_t k = 0; k < pieces; ++k) {
    const std::size_t begin = static_cast<std::size_t>(k) * kBodiesPerPiece;
    work(begin, std::min(begin + kBodiesPerPiece, bodies));
  }
}

/// What work(begin, end) returns for all pieces, joined in their order by join(so far, next).
template <class Result, class Work, class Join>
Result reduced_over_bodies(std::size_t bodies, const Work& work, const Join& join) {
  std::vector<Result> pieces((bodies + kBodiesPerPiece - 1) / kBodiesPerPiece);
  over_bodies(bodies, [&](std::size_t begin, std::size_t end) { pieces[begin / kBodiesPerPiece] = work(begin, end); });
  Result all{};
  for (const Result& piece : pieces) join(all, piece);
  return all;
}

/// Their sum.
template <class Sum, class Work>
Sum sum_over_bodies(std::size_t bodies, const Work& work) {
  return reduced_over_bodies<Sum>(bodies, work, [](Sum& all, const Sum& piece) { all += piece; });
}

}  // namespace softgrain
