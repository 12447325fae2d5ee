// The fitted law of a soft contact, ready for the loop: threshold power law in Delta = h/R, R the smaller shell
// [SP 1.5, 1.6].
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>

#include "common/contact/contact_state.h"
#include "common/core/law_range.h"
#include "common/core/limits.h"

namespace softgrain {

/// a D^b + c for D >= delta, 0 below; c = -a delta^b. Dimensionless.
struct PowerTerm {
  double a = 0.0;
  double b = 1.0;
  double c = 0.0;

  template <class T>
  [[nodiscard]] T value(const T& d) const {
    return a * power(d, b) + c;
  }
  /// Value and its derivative, for d > 0.
  template <class T>
  struct Pair {
    T value{};
    T slope{};
  };
  template <class T>
  [[nodiscard]] Pair<T> at(const T& d) const {
    const T powered = power(d, b);
    return {a * powered + c, a * b * (powered / d)};
  }
  [[nodiscard]] double integral(double d) const { return a * power(d, b + 1.0) / (b + 1.0) + c * d; }
};

/// Fn = E R^2 f(Delta), kt = E R g(Delta), |Ft| <= mu Fn, viscous damping eta = 2 zeta sqrt(m12 kn).
/// Below delta: no force, no spring, no history (the pair does not even enter the list before its skin). SI units.
struct SoftContact {
  static constexpr LawTraits traits{
      .needs_velocity = true, .has_tangential = true, .has_onset = true, .stores_energy = true, .is_fitted = true};

  PowerTerm normal;
  PowerTerm tangential;
  double delta = 0.0;            ///< threshold of both
  double modulus = 0.0;          ///< E [Pa]
  double friction = 0.0;         ///< mu_soft
  double damping = 0.0;          ///< zeta, fraction of critical
  bool partner_is_soft = false;  ///< soft-soft: the smaller radius counts; soft-solid: the soft one's
  bool i_is_soft = true;         ///< soft-solid: which of the two is soft
  LawRange range;                ///< range of Delta

  [[nodiscard]] SoftSides soft_sides() const { return {partner_is_soft || i_is_soft, partner_is_soft || !i_is_soft}; }

  /// a: radius of the shell that Delta refers to [m], b: 2 zeta sqrt(m12).
  [[nodiscard]] PairConstants pair_constants(const PairBodies& bodies) const {
    return {reference_radius(bodies), 2.0 * damping * std::sqrt(bodies.effective_mass())};
  }
  /// No limit: steps of fitted laws are bounded by their stiffness alone.
  [[nodiscard]] double impact_time(const PairBodies& /*bodies*/, double /*speed*/) const { return kInfinity; }
  /// Overlap below which the pair cannot interact [m].
  [[nodiscard]] double onset(const PairBodies& bodies) const { return delta * reference_radius(bodies); }

  /// Delta as the law takes it: no more than where it is clamped.
  template <class T>
  [[nodiscard]] T taken_ratio(const T& overlap, const T& radius) const {
    return least<T>(overlap / radius, range.clamp_at());
  }
  /// Whether the force stays at that of the end of the range: its derivative is 0, but the loop keeps the stiffness of
  /// the end, which damps the contact and bounds the step.
  template <class T>
  [[nodiscard]] Mask<T> is_clamped(const T& overlap, const T& radius) const {
    return overlap / radius > range.clamp_at();
  }
  /// Whether nothing is felt at this Delta.
  template <class T>
  [[nodiscard]] Mask<T> idle_at(const T& ratio) const {
    return ratio < delta || ratio <= 0.0;
  }
  /// The elastic part along the normal.
  template <class T>
  struct Elastic {
    T force{};      ///< [N]
    T stiffness{};  ///< [N/m]
  };
  /// Elastic force and stiffness at a Delta that is not idle.
  template <class T>
  [[nodiscard]] Elastic<T> elastic_at(const T& ratio, const T& radius) const {
    const auto [force, slope] = normal.at(ratio);
    return {modulus * radius * radius * force, modulus * radius * slope};
  }

  template <int D, class T>
  [[nodiscard]] ContactResponse<D, T> evaluate(const ContactState<D, T>& s) const {
    return respond(s, [](const auto&...) {});
  }

  /// Work of the elastic force from touch to this overlap [J].
  [[nodiscard]] double stored_energy(double overlap, const PairConstants& constants) const {
    const double radius = constants.a;
    const double ratio = std::min(overlap / radius, range.clamp_at());
    if (ratio < delta) return 0.0;
    const double beyond = overlap / radius - ratio;  // of a clamped law: at constant force
    return modulus * radius * radius * radius *
           (normal.integral(ratio) - normal.integral(delta) + beyond * normal.value(ratio));
  }

 protected:
  /// The response whose elastic part and stiffness along the contact [N/m] are those of loading, as
  /// change(loading, radius, stiffness, out) leaves them.
  template <int D, class T, class Change>
  [[nodiscard]] ContactResponse<D, T> respond(const ContactState<D, T>& s, const Change& change) const {
    ContactResponse<D, T> out;
    const T radius = s.constants.a;
    const T ratio = taken_ratio<T>(s.overlap, radius);
    const Mask<T> idle = idle_at(ratio);
    if (!any(!idle)) return out;
    const Elastic<T> loading = elastic_at<T>(ratio, radius);
    out.elastic_force = loading.force;
    out.normal_stiffness = loading.stiffness;
    T stiffness = modulus * radius * largest<T>(tangential.value(ratio), 0.0);
    change(loading, radius, stiffness, out);
    add_motion(s, stiffness, out);
    return any(idle) ? select(idle, {}, out) : out;
  }

  /// Damping and tangential force with this stiffness [N/m], on top of the elastic force and stiffness in `out`.
  template <int D, class T>
  void add_motion(const ContactState<D, T>& s, const T& stiffness, ContactResponse<D, T>& out) const {
    const T eta = s.constants.b * root(out.normal_stiffness);
    out.normal_force = out.elastic_force - eta * s.normal_speed;
    const Mask<T> held = stiffness > 0.0;
    if (!any(held)) return;
    const ContactResponse<D, T> loose = out;
    coulomb_spring<true>(s, stiffness, eta, T(friction * largest(out.normal_force, 0.0)), out);
    if (any(!held)) out = select(held, out, loose);
  }

 private:
  [[nodiscard]] double reference_radius(const PairBodies& bodies) const {
    if (partner_is_soft) return std::min(bodies.radius_i, bodies.radius_j);
    return i_is_soft ? bodies.radius_i : bodies.radius_j;
  }
};

/// How a soft contact unloads: from its deepest Delta_max along
///   F = F(Delta_max) [(Delta - Delta_p)/(Delta_max - Delta_p)]^exponent, 0 below Delta_p,
///   Delta_p = delta + residual (Delta_max - delta),
/// and back the same way, onto the loading curve at Delta_max. Walton and Braun (1986, doi:10.1122/1.549893) with a
/// power in place of their straight line; residual = 1 - 1/s with the exponent of loading and delta = 0 is the branch
/// of law tables (SoftMultiContact). Dimensionless.
struct UnloadingBranch {
  double residual = 0.0;  ///< share of the depth below the threshold that stays, 0 to kLargestResidual
  double exponent = 1.0;  ///< at least least_unloading_exponent()
};

/// A soft contact that unloads along a branch of its own. Its history is the largest overlap since it last lay below
/// the threshold. kt of the overlap falls with the force that is left, so that a contact without force has none. SI
/// units.
struct SoftUnloading : SoftContact {
  static constexpr LawTraits traits{.needs_velocity = true,
                                    .has_tangential = true,
                                    .has_memory = true,
                                    .has_onset = true,
                                    .is_fitted = true,
                                    .has_unloading = true};

  UnloadingBranch branch;

  template <int D, class T>
  [[nodiscard]] ContactResponse<D, T> evaluate(const ContactState<D, T>& s) const {
    return respond(s, [&](const Elastic<T>& loading, const T& radius, T& stiffness, ContactResponse<D, T>& out) {
      const Mask<T> returns = s.overlap < s.memory;
      if (any(returns)) {
        const Elastic<T> returned = unloading_at<T>(s.overlap / radius, s.memory / radius, radius);
        out.elastic_force = choose<T>(returns, returned.force, out.elastic_force);
        out.normal_stiffness = choose<T>(returns, returned.stiffness, out.normal_stiffness);
        // In proportion to the force that is left of that of loading.
        stiffness = choose<T>(returns && loading.force > 0.0, returned.force / loading.force, T(1.0)) * stiffness;
      }
      out.memory = largest(s.memory, s.overlap);
    });
  }

 private:
  /// Elastic force and stiffness at a Delta below the deepest one. A contact deeper than a clamped law goes unloads
  /// from where it was, with the force of the end of the range.
  template <class T>
  [[nodiscard]] Elastic<T> unloading_at(const T& at, const T& deepest, const T& radius) const {
    const T length = (1.0 - branch.residual) * (deepest - delta);  // > 0: at lies above the threshold, deepest above at
    const T share = (at - deepest + length) / length;
    const Mask<T> bears = share > 0.0;
    const T base = choose<T>(bears, share, T(1.0));
    const T force = elastic_at<T>(least<T>(deepest, range.clamp_at()), radius).force * power(base, branch.exponent);
    return {choose<T>(bears, force, T(0.0)),
            choose<T>(bears, branch.exponent * force / (base * length * radius), T(0.0))};
  }
};

/// F(Delta) = a (Delta^b - delta^b) above the threshold delta [SP 1.5], as a PowerTerm. The offset follows from a, b
/// and delta, so that the law is zero at its threshold to the last bit; the card's own c is rounded. Dimensionless; a >
/// 0, b > 0, 0 <= delta < 1 (not checked: whoever reads the card does).
inline PowerTerm threshold_term(double a, double b, double delta) { return {a, b, -a * power(delta, b)}; }

}  // namespace softgrain
