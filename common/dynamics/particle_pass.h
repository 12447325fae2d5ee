// Laws of soft particles that know of all their contacts: what every contact takes from its bodies, and the closing of
// the sums, before the loop over forces.
#pragma once

#include <cstdint>

#include "common/contact/contact_loop.h"
#include "common/system.h"

namespace softgrain {

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
