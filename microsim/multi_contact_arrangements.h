// Named sets of directions in which neighbours press on a soft particle.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/core/enum_names.h"
#include "common/data/multi_contact_measurements.h"

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
  random_8,     ///< fixed, well separated
  scattered     ///< drawn, unequally deep: see scattered_neighbours()
};

template <>
inline constexpr auto enum_names<Arrangement> = enum_name_list<Arrangement>({{Arrangement::one, "one"},
                                                                             {Arrangement::opposite, "opposite"},
                                                                             {Arrangement::orthogonal, "orthogonal"},
                                                                             {Arrangement::sixty, "sixty"},
                                                                             {Arrangement::octant, "octant"},
                                                                             {Arrangement::tetrahedron, "tetrahedron"},
                                                                             {Arrangement::cube, "cube"},
                                                                             {Arrangement::icosahedron, "icosahedron"},
                                                                             {Arrangement::beside_five, "beside-five"},
                                                                             {Arrangement::random_8, "random-8"},
                                                                             {Arrangement::scattered, "scattered"}});

/// Unit vectors, the first one along +x except for tetrahedron, icosahedron and random-8. Of scattered ones there are
/// none without a draw.
std::vector<Vec3> directions_of(Arrangement arrangement);

/// Share of the largest overlap that each neighbour gets: 1, but `shallow` for the first of beside-five.
std::vector<double> depth_shares(Arrangement arrangement, double shallow);

/// What neighbours are drawn from.
struct ScatterChoice {
  std::int64_t count = 6;        ///< number of neighbours, at least 4: fewer cannot hold a body
  std::uint64_t draw = 1;        ///< number of the draw; the same number gives the same neighbours
  double shallow = 0.3;          ///< overlaps are drawn evenly from this share of the deepest one to all of it
  std::vector<double> ratios{};  ///< radii of spheres over that of the soft particle, drawn evenly
  /// Kind of all neighbours; empty: three of five solid, every fifth a plane, every fifth soft.
  std::optional<PartnerKind> kind{};
  bool smooth = false;  ///< whether planes are without friction
};

struct ScatteredNeighbour {
  MultiContactPartner partner;
  double share = 1.0;  ///< share of the deepest overlap; one neighbour has all of it
};

/// Neighbours as bodies of a packing have them: directions that keep away from each other as well as the best of a few
/// tries does, and leave no way out (within 80 degrees of any direction there is one).
std::vector<ScatteredNeighbour> scattered_neighbours(const ScatterChoice& choice);

}  // namespace softgrain
