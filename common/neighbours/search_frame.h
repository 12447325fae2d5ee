// The box that a search for neighbours divides into cells.
#pragma once

#include "common/core/cell.h"
#include "common/core/particles.h"

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

}  // namespace softgrain
