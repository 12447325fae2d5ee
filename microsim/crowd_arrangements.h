// Named sets of directions in which neighbours press on a soft particle.
#pragma once

#include <vector>

#include "common/core/vec.h"
#include "common/core/words.h"

namespace softgrain {

enum class Arrangement {
  one,
  opposite,
  orthogonal,  ///< two, at 90 degrees
  sixty,       ///< two, at 60 degrees
  octant,      ///< three, mutually orthogonal
  tetrahedron,
  cube,         ///< +-x, +-y, +-z
  icosahedron,  ///< 12 vertices
  beside_five,  ///< cube order, +x is the shallow one
  random_8      ///< fixed, well separated
};

template <>
inline constexpr auto words<Arrangement> = word_list<Arrangement>({{Arrangement::one, "one"},
                                                                   {Arrangement::opposite, "opposite"},
                                                                   {Arrangement::orthogonal, "orthogonal"},
                                                                   {Arrangement::sixty, "sixty"},
                                                                   {Arrangement::octant, "octant"},
                                                                   {Arrangement::tetrahedron, "tetrahedron"},
                                                                   {Arrangement::cube, "cube"},
                                                                   {Arrangement::icosahedron, "icosahedron"},
                                                                   {Arrangement::beside_five, "beside-five"},
                                                                   {Arrangement::random_8, "random-8"}});

/// Unit vectors, the first one along +x except for tetrahedron, icosahedron and random-8.
std::vector<Vec3> directions_of(Arrangement arrangement);

/// Share of the largest overlap that each neighbour gets: 1, but `shallow` for the first of beside-five.
std::vector<double> depth_shares(Arrangement arrangement, double shallow);

}  // namespace softgrain
