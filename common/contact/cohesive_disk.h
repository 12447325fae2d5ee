// Cohesive disks in two dimensions [CP 3.1]: linear spring, constant adhesion in contact and a linear ramp of short
// range outside it, friction and rolling resistance that follow the elastic repulsion alone.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>

#include "common/contact/contact_state.h"
#include "common/contact/coulomb_spring.h"

namespace softgrain {

/// With h the overlap: N = K_N h - F0 + N_v in contact (N_v = eta times the closing speed, eta = zeta sqrt(4 K_N m12)),
/// N = -F0 (1 - gap/D0) for a gap up to D0, nothing beyond. kFriction: T = -K_T u_T, |T| <= mu K_N h: the Coulomb cone
/// starts at N = -F0; without it neither springs nor spins are looked at. kRolling: moment -K_r theta, |K_r theta| <=
/// mu_r K_N h, theta the elastic part of the relative rotation. No damping but the normal one; springs vanish when the
/// contact opens. Any consistent units; 2D only.
template <bool kFriction, bool kRolling>
struct CohesiveDisk {
  static_assert(kFriction || !kRolling, "the limit of rolling is a share of friction [CP 3.1]: mu_r = c mu a");
  static constexpr int dimension = 2;
  static constexpr bool has_tangential = kFriction;
  static constexpr bool has_memory = kRolling;
  static constexpr bool memory_has_sides = kRolling;  ///< theta, of i against j
  static constexpr bool has_rolling = kRolling;
  static constexpr bool needs_velocity = true;
  static constexpr bool needs_particle_pass = false;
  static constexpr bool has_onset = false;

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
  [[nodiscard]] double onset(const PairBodies&) const { return 0.0; }
  /// Gap up to which a pair interacts.
  [[nodiscard]] double reach() const { return adhesion > 0.0 ? range : 0.0; }

  template <int D>
  [[nodiscard]] ContactResponse<D> evaluate(const ContactState<D>& s) const {
    ContactResponse<D> out;
    if (s.overlap <= 0.0) {
      if (-s.overlap < reach()) out.elastic_force = out.normal_force = -adhesion * (1.0 + s.overlap / range);
      return out;
    }
    const double repulsion = normal * s.overlap;
    out.elastic_force = repulsion - adhesion;
    out.normal_stiffness = normal;
    out.normal_force = out.elastic_force - s.constants.b * s.normal_speed;
    if constexpr (kFriction) coulomb_spring(s, tangential, 0.0, friction * repulsion, out);
    if constexpr (kRolling) roll(s, repulsion, out);
    return out;
  }

 private:
  template <int D>
  void roll(const ContactState<D>& s, double repulsion, ContactResponse<D>& out) const {
    const double limit = rolling_limit * repulsion / rolling;
    out.memory = std::clamp(s.memory + s.turning[0] * s.dt, -limit, limit);
    out.rolling_moment[0] = -rolling * out.memory;
  }
};

}  // namespace softgrain
