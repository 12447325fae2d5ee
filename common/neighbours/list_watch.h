// When the neighbour list may be used up, from bounds of how far bodies move: the exact test, which looks at every
// body, runs seldom.
#pragma once

#include <cstdint>

#include "common/system.h"

namespace softgrain {

template <int D>
class ListWatch {
 public:
  /// Bodies have moved in a way that nothing is known of.
  void forget() { build_ = 0; }

  /// No body has used up more than this further share of its margin.
  void moved(double share) { used_ += share; }

  /// Makes the list valid for the positions as they are, at the same moments as update_neighbours() would.
  void require_list(System<D>& system);

 private:
  std::uint64_t build_ = 0;  ///< list that used_ belongs to; 0: unknown
  double used_ = 0.0;        ///< bound for the share of its margin that any body has used up
};

}  // namespace softgrain
