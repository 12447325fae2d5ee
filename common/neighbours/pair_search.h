// Steps of the search for pairs around hierarchical_grid.h: the box that it divides into cells, and the order of what
// it found.
#pragma once

#include <cstddef>
#include <vector>

#include "common/core/cell.h"
#include "common/core/particles.h"
#include "common/neighbours/hierarchical_grid.h"

namespace softgrain {

/// Maps positions to cell coordinates: fractional on periodic axes, the box around (nearly) all on open ones.
template <int D>
struct SearchFrame {
  const Cell<D>* cell = nullptr;
  Vec<D> low{};     ///< lower corner of the box, fractional units
  Vec<D> extent{};  ///< its size; 1 along periodic axes
  Vec<D> width{};   ///< size of the box in metres, perpendicular distance between faces

  [[nodiscard]] Vec<D> unit(const Vec<D>& x) const {
    Vec<D> s = cell->fractional(x);
    for (int k = 0; k < D; ++k) {
      s[k] = (s[k] - low[k]) / extent[k];
    }
    return s;
  }
};

/// Search frame of the grains as they are. There is at least one grain.
template <int D>
SearchFrame<D> search_frame(const Particles<D>& particles, const Cell<D>& cell);

// Pairs as the search found them, put into the order of the neighbour list.

/// All pairs of the pieces by i, then j, for slots below `grains`; the pieces are given back as they are used up. Pairs
/// are dealt out to stretches of slots first, so that all of it runs in parallel; the result is the same for any number
/// of threads.
std::vector<CandidatePair> sorted_pairs(std::vector<std::vector<CandidatePair>>& pieces, std::size_t grains);

}  // namespace softgrain
