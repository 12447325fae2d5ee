// What holds the grains of a pack during an increment: pairs that may touch, with what their contact law needs and the
// rule when to search again; and symmetry planes.
#pragma once

#include <cstdint>
#include <vector>

#include "common/statics/contact_law.h"
#include "common/statics/grain_pack.h"
#include "common/statics/unknowns.h"

namespace softgrain::statics {

/// Pairs in reach, sorted by (i, j); j >= grains: wall j - grains. Friction is stored only where a contact may have it.
struct Links {
  std::vector<std::int32_t> i;
  std::vector<std::int32_t> j;
  std::vector<NormalConstants> normal;
  std::vector<FrictionConstants> friction;  ///< empty: no contact of the pack has friction
  // Grain -> its links in ascending order, for the parallel gather.
  std::vector<std::int32_t> start;
  std::vector<std::int32_t> of_grain;
  // Positions at the search.
  std::vector<Vec3> searched_at;
  std::vector<Vec3> walls_at;

  [[nodiscard]] std::int32_t size() const { return static_cast<std::int32_t>(i.size()); }
};

/// Whether any contact of the pack can carry a tangential force.
bool has_friction(const GrainPack& pack);

/// Searches pairs at `positions`; the reference state comes from the contacts of `pack`. Throws InputError for arrays
/// of different length and values outside their range.
Links find_links(const GrainPack& pack, const std::vector<Vec3>& positions, const std::vector<Vec3>& wall_points);

/// True while no pair outside the list can have come into contact.
bool links_hold(const Links& links, const GrainPack& pack, const std::vector<Vec3>& positions,
                const std::vector<Vec3>& wall_points);

// Grains centred on symmetry planes: what the plane leaves them free to do, as a projection of displacements and
// forces. Lattices other than the simple cubic one have their mirror planes through centres [QS 2.2].

/// Whether the centre of grain g lies on wall w (within 1e-9 of its radius) and w is a symmetry plane.
bool centred_on(const GrainPack& pack, std::size_t g, std::size_t w);

/// The grains that symmetry planes hold. On one plane a grain moves within it and turns about its normal; on two planes
/// it slides along their edge, on three it follows the corner.
class SymmetryPlanes {
 public:
  SymmetryPlanes() = default;
  /// Throws InputError when planes that share a grain are not at right angles (projections would not commute).
  explicit SymmetryPlanes(const GrainPack& pack);

  [[nodiscard]] bool empty() const { return held_.empty(); }
  /// Takes out what the planes forbid; `stride` as in PackProblem.
  void project(Unknowns& v, int stride) const;
  /// Moves held grains with their planes: the normal displacement becomes that of the wall.
  void carry(Unknowns& displacement, int stride, const std::vector<Vec3>& wall_moves, double part) const;

 private:
  struct HeldGrain {
    std::size_t grain;
    std::vector<std::size_t> walls;
  };
  std::vector<HeldGrain> held_;
  std::vector<Vec3> normal_;  ///< normals of the walls
};

}  // namespace softgrain::statics
