// From a point in a void to the middle of it, or to where a smaller sphere rests against its walls.
#pragma once

#include "common/packing/clearance_field.h"

namespace softgrain {

/// Climbs the clearance from x to a local maximum: the centre and radius of a sphere that touches its neighbours from
/// all sides. The radius is the clearance there, cut at the field's reach.
PackedSphere climb(const ClearanceField& field, const Vec3& x);

/// Moves a sphere of radius r, which fits in at x, to a place near by where it touches up to three surfaces. The result
/// fits in as x did.
Vec3 settle(const ClearanceField& field, const Vec3& x, double r);

}  // namespace softgrain
