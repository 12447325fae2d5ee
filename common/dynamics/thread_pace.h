// Which share of the work each thread gets: cores differ, and other programs use them.
#pragma once

#include <cstddef>
#include <vector>

namespace softgrain {

/// What threads have been measured by. Times decide who does what, never in which order anything is summed.
struct ThreadPace {
  std::vector<double> share;    ///< share of all pairs, per thread; sum 1
  std::vector<double> seconds;  ///< spent by each since the shares were made [s]
  int passes = 0;               ///< since then
  int look_after = 64;          ///< passes between two looks at the pace: ever more, as new shares need a new plan

  /// Makes the shares anew, in proportion to the pairs per second of each thread; equal ones for another number of
  /// threads or before enough has been measured. No thread gets less than a fifth of an equal share: what it is
  /// measured by would be noise.
  void share_out(std::size_t threads);

  /// Whether the fastest thread waits for the slowest long enough for new shares to pay.
  [[nodiscard]] bool uneven() const;
};

}  // namespace softgrain
