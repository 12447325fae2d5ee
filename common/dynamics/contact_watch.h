// One look at all contacts of a state, for guards: how deep, how much energy they store, how far laws are from what
// was measured. Reads only, and copies nothing.
#pragma once

#include <cstdint>
#include <string>

#include "common/contact/law_use.h"
#include "common/system.h"

namespace softgrain {

/// "12 of 340 soft contacts beyond ... extrapolated"; empty when nothing is beyond.
std::string law_use_text(const LawUse& use);

template <int D>
struct ContactWatch {
  double overlap = 0.0;            ///< largest overlap over the radius of the smaller body
  Slot i = -1;                     ///< first body of the contact with the largest overlap
  Slot j = -1;                     ///< second body of that contact
  std::int64_t behind_planes = 0;  ///< grains whose centre is behind a plane (once per plane)
  Slot behind = -1;                ///< one of them
  double stored = 0.0;             ///< elastic energy of all contacts, tangential springs included [J]
  bool energy_known = true;        ///< false when a law in use has no energy of its own contact (multi-contact laws)
  LawUse laws;
};

/// The list of pairs must be valid for the positions, as it is after a force pass.
template <int D>
ContactWatch<D> watch_contacts(const System<D>& system);

}  // namespace softgrain
