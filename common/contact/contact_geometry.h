// Where two bodies touch and how they move there: shared by every loop over contacts.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include "common/contact/contact_state.h"

namespace softgrain {

/// Where two bodies touch, or several pairs side by side (T: lanes). Arms are signed distances along the normal:
/// contact point = x_i - arm_i n = x_j + arm_j n.
template <int D, class T = double>
struct ContactGeometry {
  T overlap{};
  Vec<D, T> normal{};  ///< unit normal that points to body i
  T arm_i{};
  T arm_j{};
  Vec<D, T> branch{};  ///< x_i - x_j (image of j nearest to i), for spheres and shells [m]
};

/// Unit vector along d, `sign` times; of length zero an arbitrary, fixed one.
template <int D, class T>
[[gnu::always_inline]] inline Vec<D, T> direction(const Vec<D, T>& d, const T& length, double sign) {
  Vec<D, T> normal = d * T(sign / length);
  const Mask<T> known = length > 0.0;
  for (int c = 0; c < D; ++c) normal[c] = choose<T>(known, normal[c], T(c == 0 ? 1.0 : 0.0));
  return normal;
}

/// Spheres that touch, radii ri and rj, d = x_i - x_j.
template <int D, class T>
[[gnu::always_inline]] inline ContactGeometry<D, T> of_spheres(const Vec<D, T>& d, const T& ri, const T& rj,
                                                               const T& touch) {
  const T distance = root(norm2(d));
  const T overlap = touch - distance;
  return {overlap, direction(d, distance, 1.0), ri - 0.5 * overlap, rj - 0.5 * overlap, d};
}

/// A sphere of radius r that touches a shell of radius `room` + r, d the vector from the centre of the shell.
template <int D, class T>
[[gnu::always_inline]] inline ContactGeometry<D, T> in_shell(const Vec<D, T>& d, const T& r, const T& room) {
  const T distance = root(norm2(d));
  const T overlap = distance - room;
  const T arm = r - 0.5 * overlap;
  return {overlap, direction(d, distance, -1.0), arm, -(distance + arm), d};
}

/// A sphere of radius r that touches a plane with unit normal n into its side, d the vector from a point of the plane.
template <int D, class T>
[[gnu::always_inline]] inline ContactGeometry<D, T> on_plane(const Vec<D, T>& d, const T& r, const Vec<D, T>& n) {
  const T overlap = r - dot(d, n);
  return {overlap, n, r - 0.5 * overlap, T(0.0), d};
}

/// False when the spheres do not overlap or are not within `reach` of each other (overlap is then minus the gap).
template <int D>
[[gnu::always_inline]] inline bool meet_sphere(const Vec<D>& d, double ri, double rj, double reach,
                                               ContactGeometry<D>& g) {
  const double touch = ri + rj;
  if (norm2(d) >= (touch + reach) * (touch + reach)) return false;
  g = of_spheres(d, ri, rj, touch);
  return true;
}

template <int D>
[[gnu::always_inline]] inline bool meet_shell(const Vec<D>& d, double r, double room, ContactGeometry<D>& g) {
  if (room > 0.0 && norm2(d) <= room * room) return false;
  g = in_shell(d, r, room);
  return true;
}

template <int D>
[[gnu::always_inline]] inline bool meet_plane(const Vec<D>& d, double r, const Vec<D>& n, ContactGeometry<D>& g) {
  g = on_plane(d, r, n);
  return !(g.overlap <= 0.0);
}

/// Splits the velocity v of i against j (without spins) along the normal; `turn` is spin_i arm_i + spin_j arm_j. Spins
/// move the contact point across the normal only.
template <int D, class T>
[[gnu::always_inline]] inline void split_motion(Vec<D, T> v, const Rot<D, T>& turn, const Vec<D, T>& normal,
                                                ContactState<D, T>& state) {
  v -= cross(turn, normal);
  state.normal_speed = dot(v, normal);
  state.sliding = v - normal * state.normal_speed;
}

}  // namespace softgrain
