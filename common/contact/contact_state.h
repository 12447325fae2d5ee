// What the loop hands to a law and what the law hands back; and the tangential spring with its Coulomb limit that
// every law with friction has. A law never commits history: it returns the new one, the caller decides (minimisers try
// states that are thrown away).
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include "common/contact/multi_contact_form.h"
#include "common/core/lanes.h"
#include "common/core/vec.h"

namespace softgrain {

/// What a law asks of a loop, and what others must know of it; the defaults are those of a frictionless elastic law.
struct LawTraits {
  int dimension = 0;                 ///< the only one that it serves; 0: it serves both
  bool needs_velocity = false;       ///< motion at the contact
  bool has_tangential = false;       ///< a tangential force with its spring; needs velocity
  bool has_memory = false;           ///< one more number of history
  bool memory_has_sides = false;     ///< memory changes its sign when seen from the other body, as an angle does
  bool has_rolling = false;          ///< bodies resist turning against each other; in space with a history of its own
  bool has_onset = false;            ///< overlaps below onset() carry nothing
  bool acts_at_distance = false;     ///< pairs interact up to a gap of reach()
  bool needs_particle_pass = false;  ///< sums over all contacts of a body: share() and finish()
  bool directions_in_sums = false;   ///< the sums know directions
  bool memory_in_sums = false;       ///< share() asks for the memory
  bool stores_energy = false;        ///< stored_energy() of a contact by itself
  bool is_fitted = false;            ///< measured over a range that it can leave
  bool is_multi_contact = false;  ///< the law is one of a table of laws whose soft particles know of all their contacts
  bool has_unloading = false;     ///< the memory is the largest overlap, from which the contact unloads along a branch
};

/// Numbers that depend on the two bodies alone, computed by the law when a pair enters the list.
template <class T>
struct ConstantsOf {
  T a{};
  T b{};
};
using PairConstants = ConstantsOf<double>;

/// Geometry and kinematics of one contact, or of several side by side (T: lanes). `normal` points to body i; overlap >
/// 0.
template <int D, class T = double>
struct ContactState {
  T overlap{};  ///< h [m]
  Vec<D, T> normal{};
  T normal_speed{};     ///< normal velocity of i relative to j, separation positive [m/s]
  Vec<D, T> sliding{};  ///< tangential velocity of i relative to j at the contact point [m/s]
  Rot<D, T> turning{};  ///< spin of i relative to j, for laws with rolling resistance [rad/s]
  double dt = 0.0;      ///< time since the history was committed [s]
  ConstantsOf<T> constants{};
  Vec<D, T> spring{};  ///< history: tangential spring [m]
  T memory{};          ///< history: one number for laws that ask for it
  Rot<D, T> roll{};    ///< history: by how much i has turned against j, of laws with rolling resistance in space [rad]
  T radius_i{};
  T radius_j{};                                  ///< 0 for a plane, negative for the inside of a shell
  const MultiContactSum<D, T>* sum_i = nullptr;  ///< sum over all contacts of body i, for laws with a particle pass
  const MultiContactSum<D, T>* sum_j = nullptr;
  const T* lost_i = nullptr;  ///< what the contact takes from body i, where a particle pass has kept it
  const T* lost_j = nullptr;
};

/// Answer of a law: force on i is normal_force * normal + tangential_force.
template <int D, class T = double>
struct ContactResponse {
  T normal_force{};              ///< [N], repulsion positive
  T elastic_force{};             ///< its part without damping [N]
  Vec<D, T> tangential_force{};  ///< [N]
  T normal_stiffness{};          ///< d elastic_force / d overlap [N/m]
  T tangential_stiffness{};      ///< [N/m]
  Mask<T> sliding{};             ///< the contact is at the Coulomb limit
  Vec<D, T> spring{};            ///< new history
  T memory{};                    ///< new history
  Rot<D, T> rolling_moment{};    ///< moment on i, the opposite on j; for laws with rolling resistance [N m]
  Rot<D, T> roll{};              ///< new history
  T rolling_stiffness{};         ///< [N m]
};

/// Lane by lane: the answer `yes` where the mask holds, else `no`.
template <int D, class T>
ContactResponse<D, T> select(const Mask<T>& mask, const ContactResponse<D, T>& yes, const ContactResponse<D, T>& no) {
  if constexpr (std::is_same_v<Mask<T>, bool>) {
    return mask ? yes : no;
  } else {
    const auto vec = [&](const auto& a, auto b) {
      for (std::size_t k = 0; k < b.v.size(); ++k) b.v[k] = choose<T>(mask, a.v[k], b.v[k]);
      return b;
    };
    return {choose<T>(mask, yes.normal_force, no.normal_force),
            choose<T>(mask, yes.elastic_force, no.elastic_force),
            vec(yes.tangential_force, no.tangential_force),
            choose<T>(mask, yes.normal_stiffness, no.normal_stiffness),
            choose<T>(mask, yes.tangential_stiffness, no.tangential_stiffness),
            (mask && yes.sliding) || (!mask && no.sliding),
            vec(yes.spring, no.spring),
            choose<T>(mask, yes.memory, no.memory),
            vec(yes.rolling_moment, no.rolling_moment),
            vec(yes.roll, no.roll),
            choose<T>(mask, yes.rolling_stiffness, no.rolling_stiffness)};
  }
}

/// Whether a law keeps what bodies have turned against each other as a vector. In the plane it is one number, `memory`.
template <int D>
constexpr bool has_roll_history(const LawTraits& law) {
  return D == 3 && law.has_rolling;
}

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

/// Tells which bodies of a contact are soft particles under a law.
struct SoftSides {
  bool i = false;
  bool j = false;
};

/// The soft bodies of a contact under this law; laws between grains have none.
template <class Law>
SoftSides soft_sides_of(const Law& law) {
  if constexpr (Law::traits.is_fitted) return law.soft_sides();
  return {};
}

/// Overlap below which the pair cannot interact [m].
template <class Law>
double onset_of(const Law& law, const PairBodies& bodies) {
  if constexpr (Law::traits.has_onset) return law.onset(bodies);
  return 0.0;
}

/// Gap up to which pairs of a law interact; nothing but contact for nearly all [m].
template <class Law>
double reach_of(const Law& law) {
  if constexpr (Law::traits.acts_at_distance) return law.reach();
  return 0.0;
}

/// Keeps a spring in the tangent plane as the normal turns: projects, keeps the magnitude. In two dimensions the
/// tangent is one direction, and the spring a length along it.
template <int D, class T>
[[gnu::always_inline]] inline Vec<D, T> carried_spring(const Vec<D, T>& spring, const Vec<D, T>& normal) {
  if constexpr (D == 2) {
    const Vec<D, T> tangent{{-normal[1], normal[0]}};
    return tangent * with_sign(root(norm2(spring)), dot(spring, tangent));
  } else {
    const Vec<D, T> flat = spring - normal * dot(spring, normal);
    const T after = norm2(flat);
    return flat * choose<T>(after > 0.0, root<T>(norm2(spring) / after), T(1.0));
  }
}

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
