// Laws of soft particles that know about all their contacts [SP 1.7.1]: the pair law on lost volumes, the isotropic
// form under one pressure, and the directional law. One struct, so that they share geometry, threshold and Newton's
// third law: the energy is a sum over soft particles, each overlap belongs to both, and the force is the sum of both
// sides'.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/contact/contact_state.h"
#include "common/contact/multi_contact_form.h"
#include "common/contact/rolling_spring.h"
#include "common/core/law_range.h"
#include "common/core/limits.h"
#include "common/core/monotone_curve.h"

namespace softgrain {

/// Constants w and m of nu = w v^m against the logarithm of R'/R; insides of shells, and planes with the friction of
/// the grains, have w = m = 1.
struct LostVolumeTable {
  MonotoneCurve log_weight;      ///< ln w over ln(R'/R)
  MonotoneCurve exponent;        ///< m over ln(R'/R); empty: common_exponent
  double common_exponent = 1.0;  ///< m at every ratio: of soft-soft pairs
  double plane_weight = 1.0;     ///< w of planes

  /// {w, m} for a partner of radius ratio * R; ratio <= 0: plane or inside of a shell.
  [[nodiscard]] PairConstants at(double ratio) const {
    if (!(ratio > 0.0) || log_weight.empty()) return {plane_weight, common_exponent};
    const double x = std::log(ratio);
    return {std::exp(log_weight.value(x)), exponent.empty() ? common_exponent : exponent.value(x)};
  }
};

/// F = sum over the soft bodies of the pair of E R^2 dnu/dx p(S)/S B, kt = kt_ratio kn, |Ft| <= mu F, no dashpots
/// (quasi-static). kUnloading: a contact that retreats from its deepest overlap x_max feels x_max - s (x_max - x)
/// instead of x (s = retreat >= 1) and comes back the same way; off, it costs nothing. unloading_ratio is a memory of
/// the isotropic form, of whole particles instead of contacts: see MultiContactSum::close(). The tangential spring
/// keeps its force while its stiffness grows and its length while that falls, so that it gives back no more than it
/// took: pressed on after a slide, a soft particle feels the drag that it felt before (results/shear_and_rolling),
/// where a spring of the new stiffness would pull up to fifteen times as hard. With kUnloading the memory is the
/// largest overlap, and the spring takes the new stiffness as it is. kRolling: bodies that turn against each other
/// across the normal by the angle theta feel the moment E R^2 R12 rolling theta, at most rolling_friction F R, R the
/// harmonic mean of both radii (R of the soft body alone against a plane and solids) and R12 as in the law of Hertz;
/// the contact then goes R12 theta over the surface. A spring of one stiffness under a limit that falls with the force:
/// it can give back no more than it took. SI units; 3D only.
template <LawForm kLawForm, bool kUnloading, bool kRolling = false>
struct SoftMultiContact {
  static constexpr LawTraits traits{.dimension = 3,
                                    .needs_velocity = true,
                                    .has_tangential = true,
                                    .has_memory = true,
                                    .has_rolling = kRolling,
                                    .needs_particle_pass = kLawForm != LawForm::pair,
                                    .directions_in_sums = kLawForm == LawForm::directional,
                                    .memory_in_sums = kUnloading,
                                    .is_fitted = true,
                                    .is_multi_contact = true,
                                    .has_unloading = kUnloading};

  static constexpr LawForm kForm = kLawForm;

  MultiContactForm form;
  LostVolumeTable partner;  ///< constants of the lost volume for the body on the other side, for this kind of pair
  double modulus = 0.0;     ///< E [Pa]
  double friction = 0.0;    ///< mu_soft
  double kt_ratio = 0.0;    ///< tangential over normal stiffness
  double unloading = 1.0;   ///< s of the unloading branch
  double rolling = 0.0;     ///< stiffness against rolling over E R^2 R12
  double rolling_friction = 0.0;  ///< largest moment over F R
  double unloading_ratio = 1.0;   ///< of a soft particle as a whole: slope of p(S) in unloading over that in loading
  bool i_is_soft = true;
  bool j_is_soft = false;

  [[nodiscard]] SoftSides soft_sides() const { return {i_is_soft, j_is_soft}; }

  /// No limit: steps of fitted laws are bounded by their stiffness alone.
  [[nodiscard]] double impact_time(const PairBodies& /*bodies*/, double /*speed*/) const { return kInfinity; }
  /// {w, m} of the soft body; of soft-soft pairs those of i, the ones of j follow from the inverse ratio.
  [[nodiscard]] PairConstants pair_constants(const PairBodies& bodies) const {
    if (i_is_soft && j_is_soft)
      return {partner.at(bodies.radius_j / bodies.radius_i).a, partner.at(bodies.radius_i / bodies.radius_j).a};
    if (i_is_soft) return partner.at(bodies.radius_j / bodies.radius_i);
    return partner.at(bodies.radius_i / bodies.radius_j);
  }

  /// What a contact takes from one of its bodies, nu.
  template <int D, class T>
  [[nodiscard]] T occupied_volume(const ContactState<D, T>& s, bool of_i) const {
    return lost(s, of_i).nu;
  }
  /// Adds that to the sums of the body; `n` is the direction from it.
  template <int D>
  static void add(double nu, const Vec<D>& n, MultiContactSum<D>& sum) {
    if constexpr (kLawForm == LawForm::isotropic)
      sum.add(nu);
    else
      sum.add(nu, n);
  }
  template <int D>
  void share(const ContactState<D>& s, bool of_i, MultiContactSum<D>& sum) const {
    if (of_i ? i_is_soft : j_is_soft) add(occupied_volume(s, of_i), of_i ? -s.normal : s.normal, sum);
  }

  /// The volume that stands for all contacts of a body.
  template <int D>
  [[nodiscard]] double equivalent(const MultiContactSum<D>& sum) const {
    return kLawForm == LawForm::directional ? form.equivalent_volume(sum) : sum.volume;
  }
  /// Whether soft particles unload from their largest equivalent volume so far, Particles::largest_volume.
  [[nodiscard]] bool remembers() const { return kLawForm == LawForm::isotropic && unloading_ratio > 1.0; }
  /// Pressure of a body whose contacts have all been added, as it loads.
  template <int D>
  void finish(MultiContactSum<D>& sum) const {
    sum.close(form.pressure, equivalent(sum));
  }

  template <int D, class T>
  [[nodiscard]] ContactResponse<D, T> evaluate(const ContactState<D, T>& s) const {
    ContactResponse<D, T> out;
    if constexpr (kUnloading) out.memory = largest(s.memory, s.overlap);
    if (i_is_soft) add_side(s, true, out);
    if (j_is_soft) add_side(s, false, out);
    out.normal_force = out.elastic_force;
    if constexpr (kRolling) roll(s, out);
    const T stiffness = kt_ratio * out.normal_stiffness;
    const Mask<T> held = stiffness > 0.0 && out.elastic_force > 0.0;
    if (!any(held)) return out;
    const ContactResponse<D, T> loose = out;
    const T limit = friction * out.elastic_force;
    if constexpr (kUnloading) {
      coulomb_spring<false>(s, stiffness, T(0.0), limit, out);
    } else {
      ContactState<D, T> shortened = s;
      shortened.spring *= choose<T>(s.memory > 0.0 && stiffness > s.memory, s.memory / stiffness, T(1.0));
      coulomb_spring<false>(shortened, stiffness, T(0.0), limit, out);
      out.memory = stiffness;
    }
    return any(!held) ? select(held, out, loose) : out;
  }

 private:
  template <int D, class T>
  void roll(const ContactState<D, T>& s, ContactResponse<D, T>& out) const {
    const T plane = T(0.0);
    const Mask<T> flat = s.radius_j == plane;
    const T other = choose<T>(flat, T(1.0), s.radius_j);
    const T both = choose<T>(flat, s.radius_i, s.radius_i * other / (s.radius_i + other));  // R12
    const T soft = i_is_soft && j_is_soft ? T(2.0 * both) : i_is_soft ? s.radius_i : s.radius_j;
    const T stiffness = modulus * rolling * soft * soft * both;
    const T limit = rolling_friction * soft * largest(out.elastic_force, T(0.0));
    angular_spring<false>(s, stiffness, T(0.0), limit, out);
    out.rolling_stiffness = choose<T>(out.elastic_force > 0.0, stiffness, T(0.0));
  }

  /// Overlap as it is felt [m].
  template <int D, class T>
  [[nodiscard]] T effective_overlap(const ContactState<D, T>& s) const {
    if constexpr (kUnloading)
      return choose<T>(s.overlap < s.memory, largest<T>(s.memory - unloading * (s.memory - s.overlap), 0.0), s.overlap);
    return s.overlap;
  }

  template <int D, class T>
  [[nodiscard]] LostVolume<T> lost(const ContactState<D, T>& s, bool of_i) const {
    const T own = of_i ? s.radius_i : s.radius_j;
    const T other = of_i ? s.radius_j : s.radius_i;
    const T curvature = choose<T>(other != 0.0, own / other, T(0.0));
    const bool both = i_is_soft && j_is_soft;
    const T w = both && !of_i ? s.constants.b : s.constants.a;
    const T m = both ? T(partner.common_exponent) : s.constants.b;
    return lost_volume(lens<T>(effective_overlap(s) / own, curvature), w, m, of_i ? s.lost_i : s.lost_j);
  }

  template <int D, class T>
  void add_side(const ContactState<D, T>& s, bool of_i, ContactResponse<D, T>& out) const {
    const LostVolume<T> nu = lost(s, of_i);
    const Mask<T> idle = nu.nu <= 0.0;  // not a number goes on
    if (!any(!idle)) return;
    const T radius = of_i ? s.radius_i : s.radius_j;
    T gain(0.0);
    T gain_slope(0.0);
    T felt = nu.nu;
    if constexpr (kLawForm == LawForm::pair) {
      const auto [p, slope] = form.pressure.at(nu.nu);
      gain = p / nu.nu;
      gain_slope = (slope - gain) / (nu.nu * nu.nu);
    } else {
      const MultiContactSum<D, T>& sum = of_i ? *s.sum_i : *s.sum_j;
      gain = sum.gain;
      gain_slope = sum.gain_slope;
      felt = kLawForm == LawForm::isotropic ? sum.volume : form.felt(sum, nu.nu, of_i ? -s.normal : s.normal);
    }
    const T force = modulus * radius * radius * nu.slope * gain * felt;
    const T bend = nu.curvature * gain * felt + nu.slope * nu.slope * (gain + gain_slope * felt * felt);
    T branch(1.0);
    if constexpr (kUnloading) branch = choose<T>(s.overlap < s.memory, T(unloading), T(1.0));
    out.elastic_force += choose<T>(idle, T(0.0), force);
    out.normal_stiffness += choose<T>(idle, T(0.0), branch * largest<T>(modulus * radius * bend, 0.0));
  }
};

}  // namespace softgrain
