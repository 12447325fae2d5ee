// Tangential spring with Coulomb limit, shared by every law with friction.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include "common/contact/contact_state.h"

namespace softgrain {

/// Spring with stiffness `stiffness` and, when kDamped, viscous damping, |force| <= limit.
/// The spring is carried into the tangent plane, lengthened by the sliding of this step and shortened to the Coulomb
/// limit [SP 1.3]; a sliding contact has no tangential damping, and damping never lifts the force above the limit.
template <bool kDamped, int D, class T>
[[gnu::always_inline]] inline void coulomb_spring(const ContactState<D, T>& s, const T& stiffness, const T& damping,
                                                  const T& limit, ContactResponse<D, T>& out) {
  Vec<D, T> spring = carried_spring(s.spring, s.normal) + s.sliding * T(s.dt);
  Vec<D, T> force = spring * -stiffness;
  const T size2 = norm2(force);
  const T limit2 = limit * limit;
  const Mask<T> slides = size2 > limit2;  // squares: no root while nothing slides
  if constexpr (kDamped) {
    Vec<D, T> damped = force - s.sliding * damping;
    const T damped2 = norm2(damped);
    const Mask<T> capped = damped2 > limit2;
    if (any(capped && !slides)) damped *= choose<T>(capped, limit / root(damped2), T(1.0));
    for (int k = 0; k < D; ++k) force[k] = choose<T>(slides, force[k], damped[k]);
  }
  if (any(slides)) {
    const T share = choose<T>(slides, limit / root(size2), T(1.0));
    spring *= share;
    force *= share;
  }
  out.tangential_stiffness = stiffness;
  out.tangential_force = force;
  out.spring = spring;
  out.sliding = slides;
}

}  // namespace softgrain
