// Tangential spring with Coulomb limit, shared by every law with friction.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include "common/contact/contact_state.h"

namespace softgrain {

/// Spring with stiffness `stiffness` and viscous damping, |force| <= limit.
/// The spring is carried into the tangent plane, lengthened by the sliding of this step and shortened to the Coulomb
/// limit [SP 1.3]; a sliding contact has no tangential damping, and damping never lifts the force above the limit.
template <int D>
[[gnu::always_inline]] inline void coulomb_spring(const ContactState<D>& s, double stiffness, double damping, double limit,
                           ContactResponse<D>& out) {
  Vec<D> spring = carried_spring(s.spring, s.normal) + s.sliding * s.dt;
  Vec<D> force = spring * -stiffness;
  const double size2 = norm2(force);
  out.tangential_stiffness = stiffness;
  if (size2 > limit * limit) {  // squares: no root while nothing slides
    const double share = limit / std::sqrt(size2);
    spring *= share;
    force *= share;
    out.sliding = true;
  } else if (damping > 0.0) {
    force -= s.sliding * damping;
    const double damped2 = norm2(force);
    if (damped2 > limit * limit) force *= limit / std::sqrt(damped2);
  }
  out.tangential_force = force;
  out.spring = spring;
}

}  // namespace softgrain
