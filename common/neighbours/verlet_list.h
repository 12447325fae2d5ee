// The neighbour list: which pairs the loop looks at, when the list must be made anew, and how histories survive that.
#pragma once

#include <cstdint>

#include "common/neighbours/skin.h"
#include "common/system.h"

namespace softgrain {

/// Makes the list valid for the positions as they are: rebuilds it when some body has moved its whole skin since the
/// last build. Called before every pass, so no pair is ever missed. Returns whether it was rebuilt. Throws
/// UnusableResult naming the body when a position is not finite or a grain is outside its shell.
template <int D>
bool update_neighbours(System<D>& system);

/// Rebuilds unconditionally: wraps periodic positions, searches pairs, sorts them by geometry, law and bodies, carries
/// histories.
template <int D>
void rebuild_neighbours(System<D>& system);

/// Completes a list of which pairs, images and sections have been restored from a file: constants of the laws, empty
/// histories, a new build number.
template <int D>
void adopt_list(System<D>& system);

// When the neighbour list may be used up, from bounds of how far bodies move: the exact test, which looks at every
// body, runs seldom.

template <int D>
class ListWatch {
 public:
  /// Bodies have moved in a way that nothing is known of.
  void forget() { build_ = 0; }

  /// No body has used up more than this further share of its margin.
  void moved(double share) { used_ += share; }

  /// Makes the list valid for the positions as they are, at the same moments as update_neighbours() would.
  void require_list(System<D>& system) {
    constexpr double kTrusted = 0.999;  // the rest covers rounding of the sums of bounds
    if (build_ != 0 && build_ == system.contacts.build && used_ < kTrusted) return;
    used_ = skin_used(system);
    if (!(used_ <= 1.0)) {
      rebuild_neighbours(system);
      used_ = 0.0;
    }
    build_ = system.contacts.build;
  }

 private:
  std::uint64_t build_ = 0;  ///< list that used_ belongs to; 0: unknown
  double used_ = 0.0;        ///< bound for the share of its margin that any body has used up
};

}  // namespace softgrain
