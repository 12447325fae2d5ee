// What the loop hands to a law and what the law hands back. A law never commits history: it returns the new one, the
// caller decides (minimisers try states that are thrown away).
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include "common/contact/crowd_form.h"
#include "common/core/vec.h"

namespace softgrain {

/// Numbers that depend on the two bodies alone, computed by the law when a pair enters the list.
struct PairConstants {
  double a = 0.0;
  double b = 0.0;
};

/// Geometry and kinematics of one contact. `normal` points to body i; overlap > 0.
template <int D>
struct ContactState {
  double overlap = 0.0;  ///< h [m]
  Vec<D> normal{};
  double normal_speed = 0.0;  ///< of i relative to j along the normal, separation positive [m/s]
  Vec<D> sliding{};           ///< tangential velocity of i relative to j at the contact point [m/s]
  Rot<D> turning{};           ///< spin of i relative to j, for laws with rolling resistance [rad/s]
  double dt = 0.0;            ///< time since the history was committed [s]
  PairConstants constants{};
  Vec<D> spring{};      ///< history: tangential spring [m]
  double memory = 0.0;  ///< history: one number for laws that ask for it
  double radius_i = 0.0;
  double radius_j = 0.0;               ///< 0 for a plane, negative for the inside of a shell
  const CrowdSum<D>* sum_i = nullptr;  ///< of the particle pass, for laws that ask for it: all contacts of body i
  const CrowdSum<D>* sum_j = nullptr;
};

/// Answer of a law: force on i is normal_force * normal + tangential_force.
template <int D>
struct ContactResponse {
  double normal_force = 0.0;          ///< [N], repulsion positive
  double elastic_force = 0.0;         ///< its part without damping [N]
  Vec<D> tangential_force{};          ///< [N]
  double normal_stiffness = 0.0;      ///< d elastic_force / d overlap [N/m]
  double tangential_stiffness = 0.0;  ///< [N/m]
  bool sliding = false;               ///< at the Coulomb limit
  Vec<D> spring{};                    ///< new history
  double memory = 0.0;                ///< new history
  Rot<D> rolling_moment{};            ///< on i, the opposite on j; of laws with rolling resistance [N m]
};

/// What a law is asked for when a pair enters the list.
struct PairBodies {
  double radius_i = 0.0;
  double radius_j = 0.0;  ///< 0 for a plane, negative for the inside of a shell
  double inverse_mass_i = 0.0;
  double inverse_mass_j = 0.0;

  /// R12: R1 R2/(R1 + R2); plane R1; inside of a shell R1 Rs/(Rs - R1) [SP 1.3].
  [[nodiscard]] double effective_radius() const {
    if (radius_j == 0.0) return radius_i;
    return radius_i * radius_j / (radius_i + radius_j);
  }
  /// m12 = m1 m2/(m1 + m2); 0 when neither body is moved by forces.
  [[nodiscard]] double effective_mass() const {
    const double sum = inverse_mass_i + inverse_mass_j;
    return sum > 0.0 ? 1.0 / sum : 0.0;
  }
};

/// Gap up to which pairs of a law interact; nothing but contact for all laws that do not say.
template <class Law>
double reach_of(const Law& law) {
  if constexpr (requires { law.reach(); }) return law.reach();
  return 0.0;
}

/// Whether bodies resist turning against each other.
template <class Law>
constexpr bool resists_rolling() {
  if constexpr (requires { Law::has_rolling; }) return Law::has_rolling;
  return false;
}

/// Whether the memory of a law changes its sign when the pair is seen from the other body, as an angle of i against j
/// does and a depth does not.
template <class Law>
constexpr bool memory_has_sides() {
  if constexpr (requires { Law::memory_has_sides; }) return Law::memory_has_sides;
  return false;
}

/// Keeps a spring in the tangent plane as the normal turns: projects, keeps the magnitude. In two dimensions the
/// tangent is one direction, and the spring a length along it.
template <int D>
[[gnu::always_inline]] inline Vec<D> carried_spring(const Vec<D>& spring, const Vec<D>& normal) {
  if constexpr (D == 2) {
    const Vec<D> tangent{{-normal[1], normal[0]}};
    return tangent * std::copysign(std::sqrt(norm2(spring)), dot(spring, tangent));
  } else {
    const Vec<D> flat = spring - normal * dot(spring, normal);
    const double before = norm2(spring);
    const double after = norm2(flat);
    return after > 0.0 ? flat * std::sqrt(before / after) : flat;
  }
}

}  // namespace softgrain
