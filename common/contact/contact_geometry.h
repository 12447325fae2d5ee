// Where two bodies touch and how they move there: shared by every loop over contacts.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include "common/contact/contact_state.h"

namespace softgrain {

/// Where two bodies touch. Arms are signed distances along the normal: contact point = x_i - arm_i n = x_j + arm_j n.
template <int D>
struct ContactGeometry {
  double overlap = 0.0;
  Vec<D> normal{};  ///< to body i
  double arm_i = 0.0;
  double arm_j = 0.0;
  Vec<D> branch{};  ///< x_i - x_j (image of j nearest to i), for spheres and shells [m]
};

/// Spheres of radii ri and rj, d = x_i - x_j. False when they do not overlap or are not within `reach` of each other
/// (overlap is then minus the gap). Coincident centres get an arbitrary, fixed normal.
template <int D>
[[gnu::always_inline]] inline bool meet_sphere(const Vec<D>& d, double ri, double rj, double reach,
                                               ContactGeometry<D>& g) {
  g.branch = d;
  const double distance2 = norm2(d);
  const double touch = ri + rj;
  if (distance2 >= (touch + reach) * (touch + reach)) return false;
  const double distance = std::sqrt(distance2);
  g.overlap = touch - distance;
  if (distance > 0.0)
    g.normal = d * (1.0 / distance);
  else
    g.normal[0] = 1.0;
  g.arm_i = ri - 0.5 * g.overlap;
  g.arm_j = rj - 0.5 * g.overlap;
  return true;
}

/// A sphere of radius r in a shell of radius `room` + r, d the vector from the centre of the shell.
template <int D>
[[gnu::always_inline]] inline bool meet_shell(const Vec<D>& d, double r, double room, ContactGeometry<D>& g) {
  g.branch = d;
  const double distance2 = norm2(d);
  if (room > 0.0 && distance2 <= room * room) return false;
  const double distance = std::sqrt(distance2);
  g.overlap = distance - room;
  if (distance > 0.0)
    g.normal = d * (-1.0 / distance);
  else
    g.normal[0] = 1.0;
  g.arm_i = r - 0.5 * g.overlap;
  g.arm_j = -(distance + g.arm_i);
  return true;
}

/// A sphere of radius r and a plane with unit normal n into its side, d the vector from a point of the plane.
template <int D>
[[gnu::always_inline]] inline bool meet_plane(const Vec<D>& d, double r, const Vec<D>& n, ContactGeometry<D>& g) {
  g.branch = d;
  g.overlap = r - dot(d, n);
  if (g.overlap <= 0.0) return false;
  g.normal = n;
  g.arm_i = r - 0.5 * g.overlap;
  g.arm_j = 0.0;
  return true;
}

/// Splits the velocity v of i against j (without spins) along the normal; `turn` is spin_i arm_i + spin_j arm_j. Spins
/// move the contact point across the normal only.
template <int D>
[[gnu::always_inline]] inline void split_motion(Vec<D> v, const Rot<D>& turn, const Vec<D>& normal,
                                                ContactState<D>& state) {
  v -= cross(turn, normal);
  state.normal_speed = dot(v, normal);
  state.sliding = v - normal * state.normal_speed;
}

}  // namespace softgrain
