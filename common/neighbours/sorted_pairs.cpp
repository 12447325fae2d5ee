#include "common/neighbours/sorted_pairs.h"

#include <omp.h>

#include <algorithm>
#include <cstdint>

#include "common/core/in_pieces.h"

namespace softgrain {

namespace {

bool before(const CandidatePair& a, const CandidatePair& b) { return a.i != b.i ? a.i < b.i : a.j < b.j; }

/// Pairs whose first body lies in one stretch of slots, sorted into `to`: counting sort by i, then every run by j.
void sort_stretch(const CandidatePair* from, std::size_t many, std::size_t first_grain, std::size_t grains,
                  CandidatePair* to) {
  std::vector<std::int32_t> next(grains + 1, 0);
  for (std::size_t k = 0; k < many; ++k) ++next[static_cast<std::size_t>(from[k].i) - first_grain + 1];
  for (std::size_t g = 1; g <= grains; ++g) next[g] += next[g - 1];
  for (std::size_t k = 0; k < many; ++k) to[next[static_cast<std::size_t>(from[k].i) - first_grain]++] = from[k];
  for (std::size_t g = 0; g < grains; ++g)  // next[g] is now where the run of g ends
    std::sort(to + (g == 0 ? 0 : next[g - 1]), to + next[g], before);
}

}  // namespace

std::vector<CandidatePair> sorted_pairs(std::vector<std::vector<CandidatePair>>& pieces, std::size_t grains) {
  const std::size_t stretches = pieces_of(grains);
  const auto many = static_cast<Slot>(pieces.size());
  const auto stretch_of = [](const CandidatePair& c) { return static_cast<std::size_t>(c.i) / kPieceLength; };
  // next[piece][stretch]: first how many, then where the next one goes.
  std::vector<std::vector<std::int32_t>> next(pieces.size(), std::vector<std::int32_t>(stretches, 0));
#pragma omp parallel for schedule(static) if (grains >= kParallelLength && omp_in_parallel() == 0)
  for (Slot piece = 0; piece < many; ++piece)
    for (const CandidatePair& c : pieces[at(piece)]) ++next[at(piece)][stretch_of(c)];
  std::vector<std::size_t> start(stretches + 1, 0);
  std::int32_t all = 0;
  for (std::size_t k = 0; k < stretches; ++k) {
    for (auto& of_piece : next) {
      const std::int32_t here = of_piece[k];
      of_piece[k] = all;
      all += here;
    }
    start[k + 1] = static_cast<std::size_t>(all);
  }
  std::vector<CandidatePair> dealt(static_cast<std::size_t>(all));
#pragma omp parallel for schedule(static) if (grains >= kParallelLength && omp_in_parallel() == 0)
  for (Slot piece = 0; piece < many; ++piece) {
    for (const CandidatePair& c : pieces[at(piece)]) dealt[at(next[at(piece)][stretch_of(c)]++)] = c;
    std::vector<CandidatePair>().swap(pieces[at(piece)]);
  }
  std::vector<CandidatePair> sorted(dealt.size());
  in_pieces(grains, [&](std::size_t begin, std::size_t end) {
    const std::size_t k = begin / kPieceLength;
    sort_stretch(dealt.data() + start[k], start[k + 1] - start[k], begin, end - begin, sorted.data() + start[k]);
  });
  return sorted;
}

}  // namespace softgrain
