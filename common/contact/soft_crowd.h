// Laws of soft particles that know about all their contacts [SP 1.7.1]: the pair law on lost volumes, the bag of grains
// under one pressure, and the directional law. One struct, so that they share geometry, threshold and Newton's third
// law: the energy is a sum over soft particles, each overlap belongs to both, and the force is the sum of both sides'.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/contact/contact_state.h"
#include "common/contact/coulomb_spring.h"
#include "common/contact/crowd_form.h"
#include "common/core/law_range.h"
#include "common/core/monotone_curve.h"

namespace softgrain {

/// Constants w and m of nu = w v^m against the logarithm of R'/R; planes and the insides of shells have w = m = 1.
struct LostVolumeTable {
  MonotoneCurve log_weight;      ///< ln w over ln(R'/R)
  MonotoneCurve exponent;        ///< m over ln(R'/R); empty: common_exponent
  double common_exponent = 1.0;  ///< m at every ratio: of soft-soft pairs

  /// {w, m} for a partner of radius ratio * R; ratio <= 0: plane or inside of a shell.
  [[nodiscard]] PairConstants at(double ratio) const {
    if (!(ratio > 0.0) || log_weight.empty()) return {1.0, common_exponent};
    const double x = std::log(ratio);
    return {std::exp(log_weight.value(x)), exponent.empty() ? common_exponent : exponent.value(x)};
  }
};

/// F = sum over the soft bodies of the pair of E R^2 dnu/dx p(S)/S B, kt = kt_ratio kn, |Ft| <= mu F, no dashpots
/// (quasi-static). kUnloading: a contact that retreats from its deepest overlap x_max feels x_max - s (x_max - x)
/// instead of x (s = retreat >= 1) and comes back the same way; off, it costs nothing. SI units; 3D only.
template <Crowd kCrowd, bool kUnloading>
struct SoftCrowd {
  static constexpr int dimension = 3;
  static constexpr bool has_tangential = true;
  static constexpr bool has_memory = kUnloading;
  static constexpr bool needs_velocity = true;
  static constexpr bool needs_particle_pass = kCrowd != Crowd::pair;
  static constexpr bool has_onset = false;

  CrowdForm form;
  LostVolumeTable partner;  ///< of the body on the other side, for this kind of pair
  double modulus = 0.0;     ///< E [Pa]
  double friction = 0.0;    ///< mu_soft
  double kt_ratio = 0.0;    ///< tangential over normal stiffness
  double retreat = 1.0;     ///< s of the unloading branch
  bool i_is_soft = true;
  bool j_is_soft = false;

  /// {w, m} of the soft body; of soft-soft pairs those of i, the ones of j follow from the inverse ratio.
  [[nodiscard]] PairConstants pair_constants(const PairBodies& bodies) const {
    if (i_is_soft && j_is_soft)
      return {partner.at(bodies.radius_j / bodies.radius_i).a, partner.at(bodies.radius_i / bodies.radius_j).a};
    if (i_is_soft) return partner.at(bodies.radius_j / bodies.radius_i);
    return partner.at(bodies.radius_i / bodies.radius_j);
  }
  [[nodiscard]] double onset(const PairBodies&) const { return 0.0; }

  /// Adds what a contact takes from one of its bodies.
  template <int D>
  void share(const ContactState<D>& s, bool of_i, CrowdSum<D>& sum) const {
    if (!(of_i ? i_is_soft : j_is_soft)) return;
    const double nu = lost(s, of_i).nu;
    if constexpr (kCrowd == Crowd::bag)
      sum.add(nu);
    else
      sum.add(nu, of_i ? -s.normal : s.normal);
  }

  /// Pressure of a body whose contacts have all been added.
  template <int D>
  void finish(CrowdSum<D>& sum) const {
    if constexpr (kCrowd == Crowd::bag)
      sum.close(form.pressure, sum.volume);
    else
      sum.close(form.pressure, form.equivalent_volume(sum));
  }

  template <int D>
  [[nodiscard]] ContactResponse<D> evaluate(const ContactState<D>& s) const {
    ContactResponse<D> out;
    if constexpr (kUnloading) out.memory = std::max(s.memory, s.overlap);
    if (i_is_soft) add_side(s, true, out);
    if (j_is_soft) add_side(s, false, out);
    out.normal_force = out.elastic_force;
    const double stiffness = kt_ratio * out.normal_stiffness;
    if (stiffness > 0.0 && out.elastic_force > 0.0)
      coulomb_spring(s, stiffness, 0.0, friction * out.elastic_force, out);
    return out;
  }

 private:
  /// Overlap as it is felt [m].
  template <int D>
  [[nodiscard]] double felt_overlap(const ContactState<D>& s) const {
    if constexpr (kUnloading)
      if (s.overlap < s.memory) return std::max(s.memory - retreat * (s.memory - s.overlap), 0.0);
    return s.overlap;
  }

  template <int D>
  [[nodiscard]] LostVolume lost(const ContactState<D>& s, bool of_i) const {
    const double own = of_i ? s.radius_i : s.radius_j;
    const double other = of_i ? s.radius_j : s.radius_i;
    const double curvature = other != 0.0 ? own / other : 0.0;
    const bool both = i_is_soft && j_is_soft;
    const double w = both && !of_i ? s.constants.b : s.constants.a;
    const double m = both ? partner.common_exponent : s.constants.b;
    return lost_volume(lens(felt_overlap(s) / own, curvature), w, m);
  }

  template <int D>
  void add_side(const ContactState<D>& s, bool of_i, ContactResponse<D>& out) const {
    const LostVolume nu = lost(s, of_i);
    if (nu.nu <= 0.0) return;  // not a number goes on
    const double radius = of_i ? s.radius_i : s.radius_j;
    double gain = 0.0;
    double gain_slope = 0.0;
    double felt = nu.nu;
    if constexpr (kCrowd == Crowd::pair) {
      const CrowdPressure::Value p = form.pressure.at(nu.nu);
      gain = p.p / nu.nu;
      gain_slope = (p.slope - gain) / (nu.nu * nu.nu);
    } else {
      const CrowdSum<D>& sum = of_i ? *s.sum_i : *s.sum_j;
      gain = sum.gain;
      gain_slope = sum.gain_slope;
      felt = kCrowd == Crowd::bag ? sum.volume : form.felt(sum, nu.nu, of_i ? -s.normal : s.normal);
    }
    out.elastic_force += modulus * radius * radius * nu.slope * gain * felt;
    const double bend = nu.curvature * gain * felt + nu.slope * nu.slope * (gain + gain_slope * felt * felt);
    const double branch = kUnloading && s.overlap < s.memory ? retreat : 1.0;
    out.normal_stiffness += branch * std::max(modulus * radius * bend, 0.0);
  }
};

}  // namespace softgrain
