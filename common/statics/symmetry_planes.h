// Grains centred on symmetry planes: what the plane leaves them free to do, as a projection of displacements and
// forces. Lattices other than the simple cubic one have their mirror planes through centres [QS 2.2].
#pragma once

#include <cstdint>
#include <vector>

#include "common/statics/grain_pack.h"
#include "common/statics/unknowns.h"

namespace softgrain::statics {

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
