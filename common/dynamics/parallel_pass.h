// The sums of forces on several threads, bit for bit those of one.
#pragma once

#include <vector>

#include "common/dynamics/block_loop.h"
#include "common/system.h"

namespace softgrain {

/// Adds all contact forces to their bodies, whose forces must be zero. Every thread owns the bodies of a stretch of
/// the space-filling curve, longer for a faster thread. Pairs with bodies of two threads are evaluated first, by one of
/// the two, and put down. Then each thread goes through the list in order: pairs of its own are evaluated and added,
/// its share of those put down is added when their turn comes. So every body gets its sums in list order, whatever the
/// number of threads and whoever owns it. `stiffness`, where it is there, gets the stiffness sums; it must be clear.
template <int D>
void parallel_pass(System<D>& system, double dt, History history, int threads, BodyStiffness* stiffness = nullptr);

/// Bodies [begin, end).
struct BodyRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// What each thread owned in the last pass: who moves its own bodies finds in its cache what it wrote there. None when
/// that pass went over another list or ran on another number of threads than may run now, and where bodies do not lie
/// in spatial order.
template <int D>
const std::vector<std::vector<BodyRange>>* owned_bodies(System<D>& system);

}  // namespace softgrain
