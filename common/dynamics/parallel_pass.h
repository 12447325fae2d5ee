// The parts of a force pass: sums on several threads, bit for bit those of one, and the particle pass before them.
#pragma once

#include <cstdint>
#include <vector>

#include "common/contact/contact_loop.h"
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

// Laws of soft particles that know of all their contacts: what every contact takes from its bodies, and the closing of
// the sums, before the loop over forces.

/// The particle pass of all laws that ask for one; must precede the loop over contacts.
template <int D>
void particle_pass(System<D>& system);

/// The bodies of one thread; by default all of them.
struct OwnBodies {
  const std::uint8_t* owner = nullptr;  ///< per body
  std::uint8_t thread = 0;

  bool operator()(Slot body) const { return owner == nullptr || owner[at(body)] == thread; }
};

/// Its parts for own bodies: sums become empty; contacts of a range take their shares; and sums are closed once all
/// sections were seen. Nothing in the plane.
template <int D>
void clear_particle_sums(System<D>& system, OwnBodies own);
template <int D>
void add_particle_shares(System<D>& system, const ContactSection& section, const PairRange& range, OwnBodies own);
template <int D>
void close_particle_sums(System<D>& system, OwnBodies own);

}  // namespace softgrain
