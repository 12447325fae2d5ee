// Cohesive disks in two dimensions [CP 3.1]: linear spring, constant adhesion in contact and a linear ramp of short
// range outside it, friction and rolling resistance that follow the elastic repulsion alone.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/contact/contact_state.h"

namespace softgrain {

/// Contact law of cohesive disks with the overlap h. In contact N = K_N h - F0 + N_v, where N_v is eta times the
/// closing speed and eta = zeta sqrt(4 K_N m12). At a gap up to D0, N = -F0 (1 - gap/D0); beyond D0 there is no force.
/// kFriction: T = -K_T u_T, |T| <= mu K_N h, so the Coulomb cone starts at N = -F0; without it the law reads neither
/// springs nor spins. kRolling: moment -K_r theta, |K_r theta| <= mu_r K_N h, where theta is the elastic part of the
/// relative rotation. Only the normal force is damped. Springs vanish when the contact opens. Any consistent units; 2D
/// only.
template <bool kFriction, bool kRolling>
struct CohesiveDisk {
  static_assert(kFriction || !kRolling, "the limit of rolling is a share of friction [CP 3.1]: mu_r = c mu a");
  static constexpr LawTraits traits{.dimension = 2,
                                    .needs_velocity = true,
                                    .has_tangential = kFriction,
                                    .has_memory = kRolling,
                                    .memory_has_sides = kRolling,  // theta, of i against j
                                    .has_rolling = kRolling,
                                    .acts_at_distance = true,
                                    .stores_energy = true};

  double normal = 0.0;         ///< K_N
  double tangential = 0.0;     ///< K_T
  double friction = 0.0;       ///< mu
  double damping = 0.0;        ///< zeta, fraction of critical
  double adhesion = 0.0;       ///< F0; 0: none
  double range = 0.0;          ///< D0 of the attraction at a distance
  double rolling = 0.0;        ///< K_r [force times length]
  double rolling_limit = 0.0;  ///< mu_r [length]

  /// a: unused, b: eta.
  [[nodiscard]] PairConstants pair_constants(const PairBodies& bodies) const {
    return {0.0, damping * std::sqrt(4.0 * normal * bodies.effective_mass())};
  }
  /// Duration of an impact under the spring alone, pi sqrt(m12/K_N) at any speed: without adhesion and damping.
  [[nodiscard]] double impact_time(const PairBodies& bodies, double /*speed*/) const {
    return std::numbers::pi * std::sqrt(bodies.effective_mass() / normal);
  }
  /// Gap up to which a pair interacts.
  [[nodiscard]] double reach() const { return adhesion > 0.0 ? range : 0.0; }

  /// The stiffest of its springs across the contact, against rolling (K_r m/I of a disk) and of the attraction's slope.
  [[nodiscard]] double stiffest(double radius) const {
    const double slope = reach() > 0.0 ? adhesion / range : 0.0;
    return std::max({normal, tangential, 2.0 * rolling / (radius * radius), slope});
  }

  /// Work of the elastic force from the end of the reach to this overlap (negative: a gap); below 0 where disks are
  /// bound.
  [[nodiscard]] double stored_energy(double overlap, const PairConstants&) const {
    if (overlap > 0.0) return 0.5 * normal * overlap * overlap - adhesion * (overlap + 0.5 * reach());
    const double left = reach() + overlap;
    return left > 0.0 ? -0.5 * adhesion * left * left / range : 0.0;
  }

  template <int D, class T>
  [[nodiscard]] ContactResponse<D, T> evaluate(const ContactState<D, T>& s) const {
    ContactResponse<D, T> out;
    const Mask<T> apart = s.overlap <= 0.0;
    const T repulsion = normal * s.overlap;
    out.elastic_force = repulsion - adhesion;
    out.normal_stiffness = T(normal);
    out.normal_force = out.elastic_force - s.constants.b * s.normal_speed;
    if constexpr (kFriction) coulomb_spring<false>(s, T(tangential), T(0.0), T(friction * repulsion), out);
    if constexpr (kRolling) roll(s, repulsion, out);
    if (any(apart)) attract(s, apart, out);
    return out;
  }

 private:
  template <int D, class T>
  void roll(const ContactState<D, T>& s, const T& repulsion, ContactResponse<D, T>& out) const {
    const T limit = rolling_limit * repulsion / rolling;
    const T angle = s.memory + s.turning[0] * s.dt;
    out.memory = choose<T>(angle < -limit, -limit, choose<T>(limit < angle, limit, angle));
    out.rolling_moment[0] = -rolling * out.memory;
    out.rolling_stiffness = T(rolling);
  }

  /// Where bodies are apart nothing is left but the attraction.
  template <int D, class T>
  void attract(const ContactState<D, T>& s, const Mask<T>& apart, ContactResponse<D, T>& out) const {
    const T pull = choose<T>(-s.overlap < reach(), -adhesion * (1.0 + s.overlap / range), T(0.0));
    const ContactResponse<D, T> here = out;
    out = select(apart, {}, here);
    out.elastic_force = choose<T>(apart, pull, here.elastic_force);
    out.normal_force = choose<T>(apart, pull, here.normal_force);
  }
};

}  // namespace softgrain
