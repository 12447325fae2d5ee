#include "common/neighbours/pair_search.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "common/core/parallel_tasks.h"

namespace softgrain {

namespace {

/// Perpendicular distance between opposite faces of the cell, per axis (upper triangular edges).
template <int D>
Vec<D> face_distances(const Cell<D>& cell) {
  Vec<D> out;
  for (int k = 0; k < D; ++k) {
    // Row k of the inverse of the edges is the gradient of the fractional coordinate k; its norm is 1/distance.
    Vec<D> gradient;
    for (int c = 0; c < D; ++c) {
      Vec<D> e;
      e[c] = 1.0;
      gradient[c] = cell.fractional(e)[k];
    }
    out[k] = 1.0 / norm(gradient);
  }
  return out;
}

/// Where most grains are along one axis; those outside go by the cells at the border. One that has flown off would
/// otherwise leave a single cell to all others.
template <int D>
void leave_out_the_far(const Particles<D>& p, const Cell<D>& cell, int axis, double& low, double& high) {
  constexpr double kWide = 16.0;  // mean deviations
  for (;;) {
    double mean = 0.0;
    double deviation = 0.0;
    for (double* sum : {&mean, &deviation}) {
      double inside = 0.0;
      double total = 0.0;
      for (Slot i = 0; i < p.grains; ++i) {
        const double s = cell.fractional(p.sphere[static_cast<std::size_t>(i)].x)[axis];
        if (!(s >= low && s <= high)) continue;
        inside += 1.0;
        total += sum == &mean ? s : std::abs(s - mean);
      }
      *sum = total / inside;
    }
    const double from = std::max(low, mean - kWide * deviation);
    const double to = std::min(high, mean + kWide * deviation);
    if (!(to - from < 0.5 * (high - low)) || !(deviation > 0.0)) return;
    low = from;
    high = to;
  }
}

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

template <int D>
SearchFrame<D> search_frame(const Particles<D>& p, const Cell<D>& cell) {
  constexpr double kSparse = 64.0;  // volume of the box over that of the grains
  SearchFrame<D> frame;
  frame.cell = &cell;
  const Vec<D> faces = face_distances(cell);
  Vec<D> low = cell.fractional(p.sphere[0].x);
  Vec<D> high = low;
  double largest = 0.0;
  double filled = 0.0;
  for (Slot i = 0; i < p.grains; ++i) {
    const Sphere<D>& sphere = p.sphere[static_cast<std::size_t>(i)];
    const Vec<D> s = cell.fractional(sphere.x);
    double cube = 1.0;
    for (int k = 0; k < D; ++k) {
      low[k] = std::min(low[k], s[k]);
      high[k] = std::max(high[k], s[k]);
      cube *= 2.0 * sphere.r;
    }
    filled += cube;
    largest = std::max(largest, 2.0 * sphere.r);
  }
  double volume = 1.0;
  for (int k = 0; k < D; ++k) {
    if (cell.periodic[static_cast<std::size_t>(k)]) {
      low[k] = 0.0;
      high[k] = 1.0;
    }
    volume *= std::max((high[k] - low[k]) * faces[k], largest);
  }
  for (int k = 0; k < D; ++k) {
    if (!cell.periodic[static_cast<std::size_t>(k)] && volume > kSparse * filled)
      leave_out_the_far(p, cell, k, low[k], high[k]);
    frame.low[k] = low[k];
    frame.extent[k] = std::max(high[k] - low[k], 1e-300);
    frame.width[k] = frame.extent[k] * faces[k];
  }
  return frame;
}

template SearchFrame<2> search_frame<2>(const Particles<2>&, const Cell<2>&);
template SearchFrame<3> search_frame<3>(const Particles<3>&, const Cell<3>&);

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
