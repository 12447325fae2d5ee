// Rolling resistance of spheres: spring, dashpot and slider.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include "common/contact/contact_state.h"
#include "common/core/material.h"

namespace softgrain {

/// Spring against rolling with |moment| <= limit: `s.roll` is the angle by which i has rolled against j, a vector
/// across the normal. It is carried along with the normal, turned by this step and shortened to the limit. A contact at
/// its limit has no dashpot, and the dashpot never lifts the moment above the limit. SI units; 3D only.
template <bool kDamped, class T>
[[gnu::always_inline]] inline void angular_spring(const ContactState<3, T>& s, const T& stiffness, const T& damping,
                                                  const T& limit, ContactResponse<3, T>& out) {
  const Vec<3, T> turned = s.turning - s.normal * dot(s.turning, s.normal);
  Vec<3, T> angle = carried_spring<3, T>(s.roll, s.normal) + turned * T(s.dt);
  const T size = root(norm2(angle)) * stiffness;
  const Mask<T> slips = size > limit;
  if (any(slips)) angle *= choose<T>(slips, limit / size, T(1.0));
  out.roll = angle;
  out.rolling_moment = angle * -stiffness;
  if constexpr (kDamped) {
    Vec<3, T> damped = out.rolling_moment - turned * damping;
    const T damped2 = norm2(damped);
    const Mask<T> capped = damped2 > limit * limit;
    if (any(capped && !slips)) damped *= choose<T>(capped, limit / root(damped2), T(1.0));
    for (int k = 0; k < 3; ++k) out.rolling_moment[k] = choose<T>(slips, out.rolling_moment[k], damped[k]);
  }
}

/// Type C of Ai, Chen, Rotter and Ooi 2011, Powder Technology 206, 269 (doi:10.1016/j.powtec.2010.09.030), as
/// `rolling sds` of LAMMPS: with v = R12 (omega_i - omega_j) x n and its integral xi, the pseudo-force
/// F = -kr xi - gr v has |F| <= mu_r Fn, and the moment on i is R12 n x F, the opposite on j. R12 = R1 R2/(R1 + R2),
/// at a plane R1. xi = R12 angle x n, so that the moment is -R12^2 (kr angle + gr turning across the normal), at most
/// mu_r R12 Fn. `tangential`: stiffness of the tangential spring [N/m], kr over it is `k.stiffness`. `dashpot`: dashpot
/// constant of the contact [N s/m], gr over it is `k.damping`. `normal_force`: not negative [N]. SI units; 3D only.
template <bool kDamped, class T>
[[gnu::always_inline]] inline void rolling_spring(const ContactState<3, T>& s, const RollingResistance& k,
                                                  const T& effective_radius, const T& tangential, const T& dashpot,
                                                  const T& normal_force, ContactResponse<3, T>& out) {
  const T square = effective_radius * effective_radius;
  out.rolling_stiffness = k.stiffness * tangential * square;
  angular_spring<kDamped>(s, out.rolling_stiffness, T(k.damping * dashpot * square),
                          T(k.friction * effective_radius * normal_force), out);
}

}  // namespace softgrain
