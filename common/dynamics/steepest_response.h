// The answer of a law that bounds the time step, where a contact unloads more steeply than it loads.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/contact/contact_state.h"

namespace softgrain {

/// What a law answers to a contact as it is or, if that is stiffer along the normal, as it begins to unload. Laws
/// without a branch for unloading have the first alone.
template <class Law, int D>
ContactResponse<D> steepest_response(const Law& law, const ContactState<D>& state) {
  ContactResponse<D> out = law.evaluate(state);
  if constexpr (Law::traits.has_unloading) {
    ContactState<D> turned = state;
    turned.memory = std::max(state.memory, std::nextafter(state.overlap, std::numeric_limits<double>::infinity()));
    const ContactResponse<D> back = law.evaluate(turned);
    if (back.normal_stiffness > out.normal_stiffness) out = back;
  }
  return out;
}

}  // namespace softgrain
