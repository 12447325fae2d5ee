// The sums of forces on several threads, bit for bit those of one.
#pragma once

#include "common/system.h"

namespace softgrain {

/// Adds all contact forces to their bodies, whose forces must be zero. Every thread owns the bodies of a slab of space.
/// Pairs with bodies of two threads are evaluated first, by the owner of the first body, and put down. Then each thread
/// goes through the list in order: pairs of its own are evaluated and added, its share of those put down is added when
/// their turn comes. So every body gets its sums in list order, whatever the number of threads.
template <int D>
void parallel_pass(System<D>& system, double dt, History history, int threads);

}  // namespace softgrain
