// One look at all contacts of a state. For guards: how deep they are, how much energy they store, how far laws are from
// what was measured; this reads only, and copies nothing. For stress: the sum of force times branch.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/core/law_range.h"
#include "common/dynamics/block_loop.h"
#include "common/system.h"

namespace softgrain {

/// "12 of 340 soft contacts beyond ... extrapolated"; empty when nothing is beyond.
std::string law_use_text(const LawUse& use);

template <int D>
struct ContactWatch {
  double overlap = 0.0;             ///< largest overlap over the radius of the smaller body
  Slot i = -1;                      ///< first body of the contact with the largest overlap
  Slot j = -1;                      ///< second body of that contact
  std::vector<Slot> behind_planes;  ///< grains whose centre is behind a plane, ascending, each once
  double stored = 0.0;              ///< elastic energy of all contacts, tangential springs included [J]
  bool energy_known = true;         ///< false when a law in use has no energy of its own contact (multi-contact laws)
  LawUse laws;
};

/// The list of pairs must be valid for the positions, as it is after a force pass.
template <int D>
ContactWatch<D> watch_contacts(const System<D>& system);

/// Sum over contacts of force times branch, per axis [N m], compression positive; over the volume it is the stress.
/// From the forces that a pass has left on the bodies: it is the sum of force times place over all bodies, less force
/// times shift of the contacts across faces of the periodic cell. These contacts alone are evaluated again. Bodies must
/// bear nothing but their contacts (no gravity). The same bits for any number of threads. Looks up the contacts across
/// faces once per neighbour list.
template <int D>
class ContactVirial {
 public:
  /// Sum of the last pass, whose history has been committed.
  Vec<D> of(System<D>& system);

 private:
  struct Across {
    std::size_t section = 0;
    ForeignPairs<D> pairs;
  };
  void find_across(const System<D>& system);

  std::uint64_t build_ = 0;
  std::vector<Across> across_;
  std::vector<Stored<D>> forces_;  ///< forces on first bodies
};

}  // namespace softgrain
