// The sums of forces on several threads, bit for bit those of one.
#pragma once

#include "common/system.h"

namespace softgrain {

/// Adds all contact forces to their bodies, whose forces must be zero. Every thread owns a run of bodies and the pairs
/// whose first body is among them. Pairs with a second body elsewhere are evaluated first and put down; then each
/// thread adds, in list order, what others put down for its bodies, its own pairs, and its share of what it put down.
/// As lists are sorted by bodies, that is the order of the whole list for every body.
template <int D>
void parallel_pass(System<D>& system, double dt, History history, int threads);

}  // namespace softgrain
