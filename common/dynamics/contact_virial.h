// The sum over contacts of force times branch, from the forces that a pass has left on the bodies.
#pragma once

#include <cstdint>
#include <vector>

#include "common/dynamics/block_loop.h"
#include "common/system.h"

namespace softgrain {

/// Sum over contacts of force times branch, per axis [N m], compression positive; over the volume it is the stress. It
/// is the sum of force times place over all bodies, less force times shift of the contacts across faces of the periodic
/// cell. These contacts alone are evaluated again. Bodies must bear nothing but their contacts (no gravity). The same
/// bits for any number of threads. Looks up the contacts across faces once per neighbour list.
template <int D>
class ContactVirial {
 public:
  /// Sum of the last pass, whose history has been committed.
  Vec<D> of(System<D>& system);

 private:
  struct Across {
    std::size_t section = 0;
    std::vector<std::int32_t> places;  ///< places of the contacts in the list
  };
  void find_across(const System<D>& system);

  std::uint64_t build_ = 0;
  std::vector<Across> across_;
  std::vector<ContactLoad> loads_;
  std::vector<ContactRoll> rolls_;
  std::vector<std::uint8_t> touches_;
};

}  // namespace softgrain
