// The mechanics of a soft particle with several contacts, dimensionless and free of any loop: what volume each contact
// takes from its shell, how the contacts add up, and what pressure answers [SP 1.7.1]. Shared by the law of the contact
// loop and by the fits.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <cmath>

#include "common/core/lanes.h"
#include "common/core/law_range.h"
#include "common/core/vec.h"

namespace softgrain {

/// The part of a sphere of radius 1 that another body covers, and how it grows with the overlap x.
template <class T>
struct Lens {
  T volume{};     ///< lens volume over the volume of the sphere
  T slope{};      ///< d volume/dx = 3/4 a^2, a the radius of the circle where the surfaces meet
  T curvature{};  ///< d slope/dx
};

/// Overlap x (in radii of the sphere) with a sphere of curvature k = R/R': 0 is a plane, negative the inside of a
/// larger sphere. With s = 1 + k: V = pi x^2 (12 - 4 s x + k x^2)/(12 (s - k x)), depth of the cap D = x (2 - k x)/(2
/// (s - k x)), a^2 = 2 D - D^2. Valid for 0 <= x < 2 and while neither sphere holds the centre of the other beyond its
/// own.
template <class T>
Lens<T> lens(const T& x, const std::type_identity_t<T>& k) {
  const T s = 1.0 + k;
  const T kx = k * x;
  const T over = 1.0 / (s - kx);
  const T depth = 0.5 * x * (2.0 - kx) * over;
  const T depth_slope = (1.0 - kx + k * depth) * over;
  return {0.75 * x * x * (1.0 + x * (kx * (1.0 / 12.0) - s * (1.0 / 3.0))) * over, 0.75 * depth * (2.0 - depth),
          1.5 * (1.0 - depth) * depth_slope};
}

/// Depth D of the plane cap with volume S: 3/4 D^2 (1 - D/3) = S, 0 <= S; from S = 1 on D is so near to 2 that the disk
/// there is not zero.
template <class T>
T cap_depth(const T& s) {
  const Mask<T> most = s > 0.5;  // what is left is a cap too
  const T part = choose<T>(most, largest<T>(1.0 - s, 1e-16), s);
  // D = x (1 - D/3)^(-1/2), x = sqrt(4 S/3), as a series in x: within 0.01. Two steps by Halley, each of which leaves
  // about the third power of an error.
  const T x = root<T>(part * (4.0 / 3.0));
  T d = x * (1.0 + x * (1.0 / 6.0 + x * (5.0 / 72.0 + x * (1.0 / 27.0 + x * 0.02228))));
  for (int step = 0; step < 2; ++step) {
    const T slope = 0.75 * d * (2.0 - d);
    const T miss = 0.75 * d * d * (1.0 - d / 3.0) - part;
    const T bend = 1.5 * (1.0 - d);
    d -= choose<T>(part > 0.0, 2.0 * miss * slope / (2.0 * slope * slope - miss * bend), T(0.0));
  }
  return choose<T>(most, 2.0 - d, d);
}

/// Pressure over E as it follows from the law of one plane, F/(E Rs^2) = a (D^b - delta^b): that plane has the disk
/// dV/dD = 3/4 (2 D - D^2), so p = F/(dV/dD), and with one plane the multi-contact law is the pair law.
struct MultiContactPressure {
  double a = 0.0;
  double b = 1.0;
  double delta = 0.0;
  LawRange range{};  ///< range of S

  template <class T>
  struct Value {
    T p{};
    T slope{};  ///< dp/dS
  };

  template <class T>
  [[nodiscard]] Value<T> at(const T& s) const {
    const double end = range.clamp_at();
    const T d = cap_depth(least<T>(s, end));
    const Mask<T> idle = d <= delta;  // not a number goes on
    if (!any(!idle)) return {};
    const T powered = power(d, b);
    const T force = a * (powered - power(delta, b));
    const T disk = 0.75 * d * (2.0 - d);
    const T p = force / disk;
    const T slope = (a * b * (powered / d) - p * 1.5 * (1.0 - d)) / (disk * disk);
    return {choose<T>(idle, T(0.0), p), choose<T>(idle || s > end, T(0.0), slope)};
  }
};

/// How strongly a contact feels another one whose direction makes an angle with cosine c with its own:
/// M(c) = m0 - m1 c - m2 c^2; a contact feels itself with 1. The isotropic form, one pressure, is m0 = 1,
/// m1 = m2 = 0.
struct MultiContactCoupling {
  double m0 = 1.0;
  double m1 = 0.0;
  double m2 = 0.0;

  [[nodiscard]] double at(double c) const { return m0 - (m1 + m2 * c) * c; }
  [[nodiscard]] double own() const { return 1.0 - at(1.0); }
};

/// What the contacts of one body add up to: nu_c the effective lost volume of contact c, n_c its direction.
/// As numbers they lie in groups of four, which the contact loop takes at once.
template <int D, class T = double>
struct alignas(sizeof(T) == sizeof(double) ? 32 : alignof(T)) MultiContactSum {
  T volume{};                             ///< sum nu
  T gain{};                               ///< p(S)/S, once all contacts are in
  T gain_slope{};                         ///< d gain/dS over S
  T square{};                             ///< sum nu^2
  Vec<D, T> first{};                      ///< sum nu n
  std::array<T, D*(D + 1) / 2> second{};  ///< sum nu n n, upper triangle by rows
  bool ready = false;                     ///< whether gain is there

  /// Adds a contact under a law that does not use directions.
  void add(const T& nu) {
    volume += nu;
    square += nu * nu;
  }

  void add(const T& nu, const Vec<D, T>& n) {
    add(nu);
    first += n * nu;
    std::size_t k = 0;
    for (int r = 0; r < D; ++r)
      for (int c = r; c < D; ++c) second[k++] += nu * n[r] * n[c];
  }

  /// All contacts are in and make an equivalent volume s.
  void close(const MultiContactPressure& pressure, const T& s) {
    const auto [p, slope] = pressure.at(s);
    set_pressure(s, p, slope);
  }

  /// The same for a particle that unloads `steeper` times as steeply from m, its largest volume at rest so far
  /// (results/law_memory): below m the pressure is that of the volume m - steeper (m - s), and loading again goes back
  /// the same way. At fixed m it is the derivative of P(m - steeper (m - s))/steeper, P' = p. This energy falls when m
  /// grows to s, so that no closed cycle gains energy.
  void close(const MultiContactPressure& pressure, const T& s, const T& m, double steeper) {
    const Mask<T> back = s < m;
    const T below = largest<T>(m - steeper * (m - s), T(0.0));
    const auto [p, slope] = pressure.at(choose<T>(back, below, s));
    set_pressure(s, p, choose<T>(back, steeper * slope, slope));
  }

  /// Pressure p and its slope dp/ds at the equivalent volume s.
  void set_pressure(const T& s, const T& p, const T& slope) {
    ready = true;
    const T ratio = p / s;
    gain = choose<T>(s > 0.0, ratio, T(0.0));
    gain_slope = choose<T>(s > 0.0, (slope - ratio) / (s * s), T(0.0));
  }

  [[nodiscard]] T second_along(const Vec<D, T>& n) const {
    T sum{};
    std::size_t k = 0;
    for (int r = 0; r < D; ++r)
      for (int c = r; c < D; ++c) sum += (c > r ? 2.0 : 1.0) * second[k++] * n[r] * n[c];
    return sum;
  }

  [[nodiscard]] T second_squared() const {
    T sum{};
    std::size_t k = 0;
    for (int r = 0; r < D; ++r)
      for (int c = r; c < D; ++c, ++k) sum += (c > r ? 2.0 : 1.0) * second[k] * second[k];
    return sum;
  }
};

/// Energy of a soft particle over E Rs^3: Phi(S) with Phi' = p and S^2 = sum_cd M(n_c.n_d) nu_c nu_d, the equivalent
/// volume. It is homogeneous of degree one in the nu, so one contact alone gives S = nu whatever the coupling is. The
/// force of a contact, over E Rs^2, is its derivative at fixed directions, p(S)/S B_c dnu_c/dx with
/// B_c = sum_d M(n_c.n_d) nu_d; three sums over the contacts are all it takes.
struct MultiContactForm {
  MultiContactPressure pressure;
  MultiContactCoupling coupling;

  /// S from the sums.
  template <int D, class T>
  [[nodiscard]] T equivalent_volume(const MultiContactSum<D, T>& sum) const {
    const T s2 = coupling.own() * sum.square + coupling.m0 * sum.volume * sum.volume - coupling.m1 * norm2(sum.first) -
                 coupling.m2 * sum.second_squared();
    return root(largest<T>(s2, 0.0));
  }

  /// B of a contact with these nu and direction; never negative (a contact does not pull).
  template <int D, class T>
  [[nodiscard]] T felt(const MultiContactSum<D, T>& sum, const T& nu, const Vec<D, T>& n) const {
    return largest<T>(coupling.own() * nu + coupling.m0 * sum.volume - coupling.m1 * dot(n, sum.first) -
                          coupling.m2 * sum.second_along(n),
                      0.0);
  }
};

/// Effective lost volume of one contact: nu = w v^m, v the volume of the lens over that of the shell. w = m = 1 is a
/// plane; other bodies have other constants.
template <class T>
struct LostVolume {
  T nu{};
  T slope{};      ///< d nu/dx
  T curvature{};  ///< d slope/dx
};

/// `known`: nu where it has been worked out before.
template <class T>
LostVolume<T> lost_volume(const Lens<T>& l, const std::type_identity_t<T>& w, const std::type_identity_t<T>& m,
                          const T* known = nullptr) {
  LostVolume<T> out{w * l.volume, w * l.slope, w * l.curvature};
  const Mask<T> bent = m != 1.0;
  if (any(bent)) {
    const T nu = known != nullptr ? *known : w * power(l.volume, m);
    const T over = 1.0 / l.volume;
    const T first = m * nu * over;
    out = {choose<T>(bent, nu, out.nu), choose<T>(bent, first * l.slope, out.slope),
           choose<T>(bent, first * (l.curvature + (m - 1.0) * l.slope * l.slope * over), out.curvature)};
  }
  const Mask<T> none = l.volume <= 0.0;  // not a number goes on
  if (!any(none)) return out;
  return {choose<T>(none, T(0.0), out.nu), choose<T>(none, T(0.0), out.slope), choose<T>(none, T(0.0), out.curvature)};
}

}  // namespace softgrain
