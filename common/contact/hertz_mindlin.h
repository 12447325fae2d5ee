// Hertz normal force, Mindlin no-slip tangential spring with Coulomb limit, Tsuji damping [SP 1.3].
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "common/contact/contact_state.h"
#include "common/contact/rolling_spring.h"
#include "common/core/material.h"

namespace softgrain {

/// How the tangential spring answers to a changing contact radius.
enum class Tangential {
  none,     ///< frictionless: no spring, no torque, no history
  mindlin,  ///< the published total form Ft = -sqrt(R12 h) Dt ht
  rescaled  ///< spring shortened as the contact grows (dFt = -kt dht while loading): never creates energy
};

/// Coefficients of a pair of materials.
struct HertzCoefficients {
  double inverse_d = 0.0;  ///< 1/D, D = 3/4 [(1-nu1^2)/E1 + (1-nu2^2)/E2] [Pa]
  double shear = 0.0;      ///< Dt, 1/Dt = (2-nu1)/(8 G1) + (2-nu2)/(8 G2) [Pa]
  double friction = 0.0;   ///< mu
  double damping = 0.0;    ///< alpha(e)
  RollingResistance rolling{};

  static HertzCoefficients of(const Material& m1, const Material& m2, double friction, double restitution,
                              const RollingResistance& rolling = {});
};

/// alpha(e) = -sqrt(5) ln e / sqrt(ln^2 e + pi^2): restitution e at any speed when the contact ends at zero overlap
/// (the dashpot may pull at the very end; nothing is clipped). e = 1: 0; e -> 0: sqrt(5). 0 <= e <= 1.
inline double tsuji_alpha(double restitution) {
  if (restitution >= 1.0) return 0.0;
  if (restitution <= 0.0) return std::sqrt(5.0);
  const double l = std::log(restitution);
  return -std::sqrt(5.0) * l / std::sqrt(l * l + std::numbers::pi * std::numbers::pi);
}

inline HertzCoefficients HertzCoefficients::of(const Material& m1, const Material& m2, double friction,
                                               double restitution, const RollingResistance& rolling) {
  const double normal = 0.75 * (m1.normal_compliance() + m2.normal_compliance());
  const double tangential = m1.tangential_compliance() + m2.tangential_compliance();
  if (!(normal > 0.0)) throw std::invalid_argument("a contact of two rigid materials has no finite stiffness");
  return {1.0 / normal, 1.0 / tangential, friction, tsuji_alpha(restitution), rolling};
}

/// Fn = sqrt(R12) h^(3/2)/D - eta vn, Ft = -sqrt(R12 h) Dt ht, |Ft| <= mu Fn,
/// eta = alpha sqrt(m12 sqrt(R12)/D) h^(1/4), the same for both directions. kRolling: rolling_spring() with the
/// tangential stiffness sqrt(R12 h) Dt and eta; with `rescaled` its angle is shortened as the tangential spring is. SI
/// units; with kRolling 3D only.
template <Tangential kTangential, bool kDamped, bool kRolling = false>
struct HertzMindlin {
  static_assert(kTangential != Tangential::none || !kRolling,
                "spheres that slide freely do not roll: nothing turns them");
  static constexpr LawTraits traits{.dimension = kRolling ? 3 : 0,
                                    .needs_velocity = kTangential != Tangential::none || kDamped,
                                    .has_tangential = kTangential != Tangential::none,
                                    .has_memory = kTangential == Tangential::rescaled,
                                    .has_rolling = kRolling,
                                    .stores_energy = true};

  HertzCoefficients k;

  /// a: sqrt(R12), b: alpha sqrt(m12 sqrt(R12)/D).
  [[nodiscard]] PairConstants pair_constants(const PairBodies& bodies) const {
    const double root = std::sqrt(bodies.effective_radius());
    return {root, k.damping * std::sqrt(bodies.effective_mass() * (root * k.inverse_d))};
  }

  /// Dashpot constant of rolling [N m s] where that of the contact is `dashpot` [N s/m].
  [[nodiscard]] double rolling_dashpot(double dashpot, const PairConstants& constants) const requires kRolling {
    return k.rolling.damping * dashpot * constants.a * constants.a * constants.a * constants.a;
  }

  /// Duration of an undamped impact at this speed [s]: 4/5 B(2/5, 1/2) h/v with the largest overlap
  /// h = (5/4 m12 v^2 D/sqrt(R12))^(2/5) (Hertz 1882; Landau and Lifshitz, Theory of Elasticity, section 9).
  [[nodiscard]] double impact_time(const PairBodies& bodies, double speed) const {
    constexpr double kShape = 2.9432751843247047;  // 4/5 B(2/5, 1/2)
    const double stiffness = pair_constants(bodies).a * k.inverse_d;
    const double overlap = std::pow(1.25 * bodies.effective_mass() * speed * speed / stiffness, 0.4);
    return kShape * overlap / speed;
  }

  /// Work of the elastic force from touch to this overlap [J]: 2/5 F h.
  [[nodiscard]] double stored_energy(double overlap, const PairConstants& constants) const {
    return 0.4 * constants.a * k.inverse_d * overlap * overlap * std::sqrt(overlap);
  }

  template <int D, class T>
  [[nodiscard]] ContactResponse<D, T> evaluate(const ContactState<D, T>& s) const {
    ContactResponse<D, T> out;
    const T root_h = root(s.overlap);
    const T contact_radius = s.constants.a * root_h;
    out.elastic_force = contact_radius * s.overlap * k.inverse_d;
    out.normal_stiffness = 1.5 * contact_radius * k.inverse_d;
    out.normal_force = out.elastic_force;
    T eta(0.0);
    if constexpr (kDamped) {
      eta = s.constants.b * root(root_h);
      out.normal_force -= eta * s.normal_speed;
    }
    if constexpr (traits.has_tangential) tangential(s, contact_radius, eta, out);
    return out;
  }

 private:
  template <int D, class T>
  void tangential(const ContactState<D, T>& s, const T& contact_radius, const T& eta,
                  ContactResponse<D, T>& out) const {
    const T limit = k.friction * largest(out.normal_force, 0.0);
    if constexpr (kTangential == Tangential::rescaled) {
      ContactState<D, T> shortened = s;
      const T share = choose<T>(s.memory > 0.0 && contact_radius > s.memory, s.memory / contact_radius, T(1.0));
      shortened.spring *= share;
      coulomb_spring<kDamped>(shortened, T(contact_radius * k.shear), eta, limit, out);
      out.memory = contact_radius;
      if constexpr (kRolling) {
        shortened.roll *= share;
        roll(shortened, eta, out);
      }
    } else {
      coulomb_spring<kDamped>(s, T(contact_radius * k.shear), eta, limit, out);
      if constexpr (kRolling) roll(s, eta, out);
    }
  }

  template <class T>
  void roll(const ContactState<3, T>& s, const T& eta, ContactResponse<3, T>& out) const {
    rolling_spring<kDamped>(s, k.rolling, T(s.constants.a * s.constants.a), out.tangential_stiffness, eta,
                            largest(out.normal_force, 0.0), out);
  }
};

}  // namespace softgrain
