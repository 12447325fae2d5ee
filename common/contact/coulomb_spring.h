// Tangential spring with Coulomb limit, shared by every law with friction.
#pragma once

#include <algorithm>

#include "common/contact/contact_state.h"

namespace softgrain {

/// Spring with stiffness `stiffness` and viscous damping, |force| <= limit.
/// The spring is carried into the tangent plane, lengthened by the sliding of this step and shortened to the Coulomb
/// limit [SP 1.3]; a sliding contact has no tangential damping, and damping never lifts the force above the limit.
template <int D>
inline void coulomb_spring(const ContactState<D>& s, double stiffness, double damping, double limit,
                           ContactResponse<D>& out) {
  Vec<D> spring = carried_spring(s.spring, s.normal) + s.sliding * s.dt;
  const double length = norm(spring);
  out.tangential_stiffness = stiffness;
  if (stiffness * length > limit) {
    spring *= limit / (stiffness * length);
    out.sliding = true;
    out.tangential_force = spring * -stiffness;
  } else {
    Vec<D> force = spring * -stiffness;
    if (damping > 0.0) {
      force -= s.sliding * damping;
      const double size = norm(force);
      if (size > limit) force *= limit / size;
    }
    out.tangential_force = force;
  }
  out.spring = spring;
}

}  // namespace softgrain
