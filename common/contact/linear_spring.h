// Linear spring and dashpot with a Coulomb-limited tangential spring.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <numbers>

#include "common/contact/contact_state.h"
#include "common/contact/rolling_spring.h"

namespace softgrain {

/// Fn = kn h - eta vn with eta = 2 zeta sqrt(kn m12), zeta = -ln e / sqrt(ln^2 e + pi^2) (restitution e at any speed,
/// contact ending at zero force of the undamped clock, as for the Tsuji form); Ft = -kt ht, |Ft| <= mu max(Fn, 0).
/// kRolling: rolling_spring() with kt and eta. SI units; with kRolling 3D only.
template <bool kRolling>
struct LinearSpringLaw {
  static constexpr LawTraits traits{.dimension = kRolling ? 3 : 0,
                                    .needs_velocity = true,
                                    .has_tangential = true,
                                    .has_rolling = kRolling,
                                    .stores_energy = true};

  double normal = 0.0;      ///< kn [N/m]
  double tangential = 0.0;  ///< kt [N/m]
  double friction = 0.0;    ///< mu
  double damping = 0.0;     ///< zeta, fraction of critical
  RollingResistance rolling{};

  static double zeta(double restitution) {
    if (restitution >= 1.0) return 0.0;
    if (restitution <= 0.0) return 1.0;
    const double l = std::log(restitution);
    return -l / std::sqrt(l * l + std::numbers::pi * std::numbers::pi);
  }

  /// a: R12 with kRolling, else unused, b: eta.
  [[nodiscard]] PairConstants pair_constants(const PairBodies& bodies) const {
    return {kRolling ? bodies.effective_radius() : 0.0, 2.0 * damping * std::sqrt(normal * bodies.effective_mass())};
  }

  /// Dashpot constant of rolling [N m s] where that of the contact is `dashpot` [N s/m].
  [[nodiscard]] double rolling_dashpot(double dashpot, const PairConstants& constants) const requires kRolling {
    return rolling.damping * dashpot * constants.a * constants.a;
  }

  /// Duration of an undamped impact, pi sqrt(m12/kn) at any speed [s].
  [[nodiscard]] double impact_time(const PairBodies& bodies, double /*speed*/) const {
    return std::numbers::pi * std::sqrt(bodies.effective_mass() / normal);
  }

  /// Work of the elastic force from touch to this overlap [J].
  [[nodiscard]] double stored_energy(double overlap, const PairConstants&) const {
    return 0.5 * normal * overlap * overlap;
  }

  template <int D, class T>
  [[nodiscard]] ContactResponse<D, T> evaluate(const ContactState<D, T>& s) const {
    ContactResponse<D, T> out;
    out.elastic_force = normal * s.overlap;
    out.normal_stiffness = T(normal);
    out.normal_force = out.elastic_force - s.constants.b * s.normal_speed;
    coulomb_spring<true>(s, T(tangential), s.constants.b, T(friction * largest(out.normal_force, 0.0)), out);
    if constexpr (kRolling)
      rolling_spring<true>(s, rolling, s.constants.a, T(tangential), s.constants.b, largest(out.normal_force, 0.0),
                           out);
    return out;
  }
};

using LinearSpring = LinearSpringLaw<false>;

}  // namespace softgrain
