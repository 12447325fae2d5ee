// The laws a contact of the least-work solver can have, as types, and the response of one link under each. What a law
// does not have is neither loaded nor computed.
#pragma once

#include <numbers>

#include "common/statics/contact_law.h"
#include "common/statics/links.h"

namespace softgrain::statics {

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
    const double limit = kShare * c.contact_radius0 * limit_by_reference(c, normal.force);
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
