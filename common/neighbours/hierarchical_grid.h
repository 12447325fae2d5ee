// All pairs of spheres within reach, by a grid per size class: cost per grain does not depend on the size ratio.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/cell.h"
#include "common/core/particles.h"

namespace softgrain {

/// A pair of grains; `image` is the periodic image of j that is near i.
struct CandidatePair {
  Slot i = 0;
  Slot j = 0;  ///< > i
  std::int32_t image = 0;
};

/// A grain in messages: by the number it was added with.
template <int D>
std::string grain_name(const Particles<D>& particles, Slot slot);

/// Distance between a body and its nearest periodic image [m]; infinite in an open cell.
template <int D>
double shortest_period(const Cell<D>& cell);

/// Every pair of grains i < j (slots [0, grains)) with |x_i - x_j| < r_i + r_j + skin_i + skin_j, each once,
/// sorted by i, then j. Size classes halve the radius; of two
/// classes the one that has less to look at searches the other. Images of a body must be at least two diameters of the
/// largest grain with skin apart (throws InputError): a pair then meets in one image only. A grain that is not inside
/// the cell along a periodic axis has diverged (throws UnusableResult); along open ones it may be anywhere.
template <int D>
std::vector<CandidatePair> candidate_pairs(const Particles<D>& particles, const Cell<D>& cell,
                                           const std::vector<double>& skin);

/// Finds the pairs of candidate_pairs() by testing all pairs: the reference of the tests.
template <int D>
std::vector<CandidatePair> candidate_pairs_brute_force(const Particles<D>& particles, const Cell<D>& cell,
                                                       const std::vector<double>& skin);

}  // namespace softgrain
