// Spring that stiffens with the overlap, without friction and damping: the example of tests/new_law.py.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cmath>
#include <numbers>

#include "common/contact/contact_state.h"

namespace softgrain {

/// Fn = kn h (1 + h/h0) >= 0 with the tangent stiffness kn (1 + 2 h/h0), the second-order expansion of any smooth
/// repulsion about first touch. SI units. It shows all that the concept ContactLaw asks for; linear_spring.h shows
/// friction and damping, cohesive_disk.h attraction at a distance.
struct ExampleLaw {
  static constexpr LawTraits traits{.stores_energy = true};

  double normal = 0.0;            ///< kn [N/m], above 0
  double doubling_overlap = 0.0;  ///< h0 [m], above 0: here the force is twice that of a linear spring

  [[nodiscard]] PairConstants pair_constants(const PairBodies& /*bodies*/) const { return {}; }

  /// Lower bound of the duration of an impact [s]. A linear spring reaches h1 = v sqrt(m12/kn), further than this one,
  /// whose secant stiffness up to there is at most kn (1 + h1/h0); the softer spring turns later (Sturm).
  [[nodiscard]] double impact_time(const PairBodies& bodies, double speed) const {
    const double mass = bodies.effective_mass();
    const double deepest = speed * std::sqrt(mass / normal);
    return std::numbers::pi * std::sqrt(mass / (normal * (1.0 + deepest / doubling_overlap)));
  }

  /// Work of the elastic force from touch to this overlap [J].
  [[nodiscard]] double stored_energy(double overlap, const PairConstants&) const {
    return normal * overlap * overlap * (0.5 + overlap / (3.0 * doubling_overlap));
  }

  template <int D, class T>
  [[nodiscard]] ContactResponse<D, T> evaluate(const ContactState<D, T>& s) const {
    ContactResponse<D, T> out;
    const T relative = s.overlap * T(1.0 / doubling_overlap);
    out.elastic_force = normal * s.overlap * (1.0 + relative);
    out.normal_force = out.elastic_force;
    out.normal_stiffness = normal * (1.0 + 2.0 * relative);
    return out;
  }
};

}  // namespace softgrain
