// Pairs as the search found them, put into the order of the neighbour list.
#pragma once

#include <cstddef>
#include <vector>

#include "common/neighbours/hierarchical_grid.h"

namespace softgrain {

/// All pairs of the pieces by i, then j, for slots below `grains`; the pieces are given back as they are used up. Pairs
/// are dealt out to stretches of slots first, so that all of it runs in parallel; the result is the same for any number
/// of threads.
std::vector<CandidatePair> sorted_pairs(std::vector<std::vector<CandidatePair>>& pieces, std::size_t grains);

}  // namespace softgrain
