// Named sets of directions in which neighbours press on a soft particle.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "common/core/vec.h"

namespace softgrain {

/// one; opposite; orthogonal and sixty (two, at 90 and 60 degrees); octant (three, mutually orthogonal); tetrahedron;
/// cube (+-x, +-y, +-z); icosahedron (12 vertices); beside-five (cube order, +x is the shallow one); random-8 (fixed,
/// well separated).
inline constexpr std::array kArrangements{"one",         "opposite", "orthogonal",  "sixty",       "octant",
                                          "tetrahedron", "cube",     "icosahedron", "beside-five", "random-8"};

/// Unit vectors, the first one along +x except for tetrahedron, icosahedron and random-8. Throws BadInput for an
/// unknown name.
std::vector<Vec3> arrangement(const std::string& name);

/// Share of the largest overlap that each neighbour gets: 1, but `shallow` for the first of beside-five.
std::vector<double> depth_shares(const std::string& name, double shallow);

}  // namespace softgrain
