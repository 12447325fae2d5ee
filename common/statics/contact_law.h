// One contact of the least-work solver [QS 2.1]: the Hertz force of the dynamics, tangential force with stick and slip,
// torsion, and their stiffness. Value structs and inline evaluations; no storage.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/contact/hertz_mindlin.h"
#include "common/core/vec.h"
#include "common/statics/least_work.h"

namespace softgrain::statics {

/// What the normal force P = 4/3 E* sqrt(R*) h^(3/2) of Hertz needs: 1/E* = (1 - nu_i^2)/E_i + (1 - nu_j^2)/E_j,
/// 1/R* = 1/R_i + 1/R_j; at a wall R_j is infinite.
struct NormalConstants {
  double hertz = 0.0;        ///< 4/3 E* sqrt(R*) [Pa m^(1/2)]
  double root_radius = 0.0;  ///< sqrt(R*) [m^(1/2)]
};

/// What friction and torsion need, the reference state included. Stiffnesses of an elastic contact circle of radius
/// a = sqrt(R* h) without slip [QS 2.1]: k* along it (Mindlin 1949, doi:10.1115/1.4009973), k_t* about its normal.
struct FrictionConstants {
  double shear = 0.0;            ///< k*/a = 8/[(2-nu_i)/G_i + (2-nu_j)/G_j] [Pa]; 0: no friction
  double twist = 0.0;            ///< k_t*/a^3 = 16/3 /(1/G_i + 1/G_j) [Pa]
  double friction = 0.0;         ///< mu [1], not negative; may be infinite
  bool fresh = false;            ///< apart in the reference state
  double overlap0 = 0.0;         ///< overlap in the reference state, negative when apart [m]
  double contact_radius0 = 0.0;  ///< a0 [m]
  double limit0 = 0.0;           ///< mu P0 [N]
  Vec3 tangential0{};            ///< Q0 [N]; above mu P0 where P fell in the increment that led here
  double torsion0 = 0.0;         ///< M0.n [N m]; likewise above (3 pi/16) a0 mu P0
};

/// Where a contact is now. Displacements are those since the reference state.
struct ContactPlace {
  Vec3 normal{};                ///< unit, to i
  double overlap = 0.0;         ///< h [m]
  double arm_i = 0.0;           ///< distance of the centre of i from the contact disk; R_ij = -n arm_i
  double arm_j = 0.0;           ///< R_ji = n arm_j; 0 for walls
  double inverse_length = 0.0;  ///< 1/|r_ij|; 0 for walls, whose normal does not turn
};

/// h and n of two spheres; `r` = r_i - r_j of length `d`. Arms to the plane of the circle in which the spheres meet.
inline ContactPlace place_of_spheres(const Vec3& r, double d, double radius_i, double radius_j) {
  ContactPlace p;
  p.inverse_length = 1.0 / d;
  p.normal = r * p.inverse_length;
  p.overlap = radius_i + radius_j - d;
  const double shift = 0.5 * (radius_i - radius_j) * (radius_i + radius_j) * p.inverse_length;
  p.arm_i = 0.5 * d + shift;
  p.arm_j = 0.5 * d - shift;
  return p;
}

/// A sphere whose centre is `distance` above a wall.
inline ContactPlace place_at_wall(const Vec3& wall_normal, double distance, double radius) {
  return {wall_normal, radius - distance, distance, 0.0, 0.0};
}

/// P = 4/3 E* sqrt(R*) h^(3/2), its stiffness dP/dh and its work (8/15) E* sqrt(R*) h^(5/2).
struct NormalForce {
  double force = 0.0;      ///< [N]
  double stiffness = 0.0;  ///< [N/m]
  double work = 0.0;       ///< [J]
};
/// At an overlap [m] that is not negative.
inline NormalForce hertz_force(const NormalConstants& c, double overlap) {
  HertzMindlin<Tangential::none, false> law;
  law.k.inverse_d = 1.0;
  ContactState<3> state;
  state.overlap = overlap;
  state.constants.a = c.hertz;  // the modulus with the radius: one product for each state less
  const auto response = law.evaluate(state);
  return {response.elastic_force, response.normal_stiffness, 0.4 * response.elastic_force * overlap};
}

/// u_s = T (u_i - u_j) + Omega_i x R_ij - Omega_j x R_ji [m], T the projection on the tangent plane; `moved` is u_i -
/// u_j, turns are rotations [rad] [QS 2.1].
inline Vec3 sliding_displacement(const ContactPlace& p, const Vec3& moved, const Vec3& turn_i, const Vec3& turn_j) {
  const Vec3 rolled = moved + cross(p.normal, turn_i * p.arm_i + turn_j * p.arm_j);
  return rolled - p.normal * dot(p.normal, rolled);
}

/// The reference force turned into the tangent plane with its magnitude kept, |Q0| T Q0/|T Q0|.
inline Vec3 turned_force(const Vec3& reference, const Vec3& normal) {
  const Vec3 flat = reference - normal * dot(normal, reference);
  const double size2 = norm2(flat);
  return size2 > 0.0 ? flat * std::sqrt(norm2(reference) / size2) : Vec3{};
}

/// k' of the published rule: the stiffness that leaves |Qp - k' u_s| = limit. Never negative; 0 without a solution.
inline double slip_stiffness(double along, double size2, double force2, double limit) {
  const double room = (limit * limit - force2) * size2;
  const double radicand = along * along + room;
  if (radicand < 0.0) return 0.0;
  const double root = std::sqrt(radicand);
  // The same number without cancellation when the displacement opposes the force.
  const double numerator = along < 0.0 ? room / (root - along) : along + root;
  return std::max(0.0, numerator / size2);
}

/// Q on i, its secant stiffness in the sense Q = Qp - stiffness u_s, and its part of Pi.
struct TangentialForce {
  Vec3 force{};            ///< [N]
  double work = 0.0;       ///< [J]
  double limit = 0.0;      ///< Qmax [N]
  double stiffness = 0.0;  ///< secant stiffness, in slip lowered so that |Q| = Qmax [N/m]
  double stick = 0.0;      ///< the stiffness without slip [N/m]
  bool follows = false;    ///< |Q| is mu P of the state as it is
};

/// Share of the limit that the reference force may take up. In slip Q lies where the ray from Qp against u_s leaves the
/// circle |Q| = Qmax. When Qp is on the circle itself, a ray that just misses the inside leaves at once, Q = Qp, and
/// one that just enters it does not slip at all, Q = Qp - k* u_s: next to a jump when the contact moves sideways. From
/// inside the circle Q changes by no more than about k*/sqrt(2 (1 - kReferenceShare)) per displacement.
inline constexpr double kReferenceShare = 1.0 - 1e-3;
/// A contact about to open lets go of Q: |Q| is at most kOpening mu P, so that it does not jump where the contact
/// opens.
inline constexpr double kOpening = 100.0;

/// Published rule: limit of the reference state, stiffness lowered to k' in slip; a contact that carries more than mu
/// P0 keeps what it carries, k' = 0, so that its limit is |Qp|. With the two deviations above, without which there need
/// be no equilibrium.
inline TangentialForce tangential_by_reference(const FrictionConstants& c, double normal_force, const Vec3& turned,
                                               const Vec3& slid) {
  TangentialForce out;
  const double carried = norm(turned);
  out.limit = std::max(c.limit0, carried);
  out.stiffness = out.stick = c.shear * c.contact_radius0;
  const double held = kReferenceShare * out.limit;
  const Vec3 pushed = carried > held ? turned * (held / carried) : turned;
  out.force = pushed - slid * out.stiffness;
  const double along = dot(pushed, slid);
  const double size2 = norm2(slid);
  if (norm2(out.force) > out.limit * out.limit && size2 > 0.0) {
    out.stiffness = slip_stiffness(along, size2, norm2(pushed), out.limit);
    out.force = pushed - slid * out.stiffness;
  }
  out.work = 0.5 * out.stiffness * size2 - along;
  const double most = kOpening * c.friction * normal_force;
  if (most < out.limit && norm2(out.force) > most * most) {
    const double share = most / norm(out.force);
    out.force *= share;
    out.stiffness *= share;
    out.work *= share;
  }
  return out;
}

/// Return mapping to mu P of the state as it is [QS 2.4]. A contact made in the increment has slid only since it closed
/// (the part h/(h - h0) of the displacement) and its stiffness has the current contact radius.
inline TangentialForce tangential_by_current(const FrictionConstants& c, double normal_force, double overlap,
                                             double root_radius, const Vec3& pushed, const Vec3& slid_in_all) {
  TangentialForce out;
  const double part = c.fresh ? overlap / (overlap - c.overlap0) : 1.0;
  const double radius = c.fresh ? root_radius * std::sqrt(overlap) : c.contact_radius0;
  const double stick = c.shear * radius;
  const Vec3 slid = slid_in_all * part;
  out.limit = c.friction * normal_force;
  out.force = pushed - slid * stick;
  out.work = 0.5 * stick * norm2(slid) - dot(pushed, slid);
  const double size = norm(out.force);
  double share = 1.0;
  if (size > out.limit) {
    share = out.limit / size;
    out.follows = true;
    out.work = (out.limit * (size - 0.5 * out.limit) - 0.5 * norm2(pushed)) / stick;
  } else if (std::isinf(c.friction) && overlap < c.overlap0) {
    // Without a limit Q would vanish at once where a contact opens: it falls with the contact radius.
    share = std::sqrt(overlap / c.overlap0);
    out.work *= share;
  }
  out.force *= share;
  out.stick = stick * part;
  out.stiffness = out.stick * share;
  return out;
}

/// M.n on i, its stiffness and its part of Pi.
struct TorsionMoment {
  double moment = 0.0;     ///< [N m]
  double stiffness = 0.0;  ///< k_t [N m]
  double work = 0.0;       ///< [J]
};

/// M = M0 - k_t Omega_t, |M| at most (3 pi/16) a mu P: the moment of a circle under the pressure of Hertz that slides
/// everywhere [QS 2.1]. Torsion is tangential friction of one component: the same two rules. `radius`: a0 or, of a
/// fresh contact, a [m]; `turned`: Omega_t [rad].
inline TorsionMoment torsion_moment(const FrictionConstants& c, double radius, double limit, double turned) {
  TorsionMoment out;
  out.stiffness = c.twist * radius * radius * radius;
  out.moment = c.torsion0 - out.stiffness * turned;
  out.work = turned * (0.5 * out.stiffness * turned - c.torsion0);
  if (std::abs(out.moment) > limit) {
    out.moment = std::copysign(limit, out.moment);
    // With k' of the published rule, k' Omega_t = Mp - M.
    out.work = -0.5 * turned * (c.torsion0 + out.moment);
    out.stiffness = 0.0;
  }
  return out;
}

struct FrictionlessLaw {
  static constexpr bool friction = false;
  static constexpr bool torsion = false;
  static constexpr int stride = 3;
  static constexpr CoulombRule rule = CoulombRule::reference;
};

template <CoulombRule kRule, bool kTorsion>
struct FrictionLaw {
  static constexpr bool friction = true;
  static constexpr bool torsion = kTorsion;
  static constexpr int stride = 6;
  static constexpr CoulombRule rule = kRule;
};

/// Everything a closed contact answers.
struct ContactResponse {
  NormalForce normal;
  TangentialForce tangential;
  TorsionMoment torsion;
};

template <class Law>
TorsionMoment torsion_response(const FrictionConstants& c, const NormalForce& normal, double root_radius,
                               const ContactPlace& place, const Vec3& turn_i, const Vec3& turn_j) {
  constexpr double kShare = 3.0 * std::numbers::pi / 16.0;
  const double turned = dot(turn_i - turn_j, place.normal);
  if constexpr (Law::rule == CoulombRule::reference) {
    const double arm = kShare * c.contact_radius0;
    const double most = arm * kOpening * c.friction * normal.force;
    const double limit = std::min(std::max(arm * c.limit0, std::abs(c.torsion0)), most);
    return torsion_moment(c, c.contact_radius0, limit, turned);
  } else {
    if (c.friction == 0.0) return {};
    const double radius = root_radius * std::sqrt(place.overlap);
    const double limit = kShare * radius * c.friction * normal.force;
    if (!c.fresh) return torsion_moment(c, c.contact_radius0, limit, turned);
    const double part = place.overlap / (place.overlap - c.overlap0);
    TorsionMoment out = torsion_moment(c, radius, limit, turned * part);
    out.stiffness *= part;
    return out;
  }
}

/// `slid`: u_s; `friction` may be null when the law has none. `turn`: Omega.
template <class Law>
ContactResponse respond(const NormalConstants& constants, const FrictionConstants* friction, const ContactPlace& place,
                        const Vec3& moved, const Vec3& turn_i, const Vec3& turn_j) {
  ContactResponse out;
  out.normal = hertz_force(constants, place.overlap);
  if constexpr (Law::friction) {
    const Vec3 slid = sliding_displacement(place, moved, turn_i, turn_j);
    const Vec3 pushed = turned_force(friction->tangential0, place.normal);
    if constexpr (Law::rule == CoulombRule::reference) {
      out.tangential = tangential_by_reference(*friction, out.normal.force, pushed, slid);
    } else {
      out.tangential =
          tangential_by_current(*friction, out.normal.force, place.overlap, constants.root_radius, pushed, slid);
    }
    if constexpr (Law::torsion)
      out.torsion = torsion_response<Law>(*friction, out.normal, constants.root_radius, place, turn_i, turn_j);
  }
  return out;
}

}  // namespace softgrain::statics
