// The tables [cell] and [[wall]].
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "common/core/cell.h"
#include "common/core/particles.h"
#include "common/io/scene.h"
#include "common/system.h"
#include "microsim/particles/scene_bodies.h"
#include "microsim/particles/scene_contacts.h"

namespace softgrain {

/// What `inside` of a particle says where no wall holds it.
inline constexpr const char* kNoWall = "none";

/// One wall, not yet a body.
template <int D>
struct SceneWall {
  NewBody<D> body;  ///< radius 0 for planes; mass only for planes moved by a force
  bool plane = true;
  Vec<D> normal{};          ///< unit
  double load = 0.0;        ///< along the normal [N]
  bool needs_mass = false;  ///< moved by a force, mass not given: that of all particles is taken
  std::string name;
  std::string where;  ///< "file:line"

  /// Whether it is a sphere-inside around this place.
  [[nodiscard]] bool holds(const Vec<D>& x) const { return !plane && norm(x - body.x) < body.r; }
};

/// The first sphere-inside that holds a centre, -1 without: it is that of a particle there which names none.
template <int D>
std::ptrdiff_t wall_around(const std::vector<SceneWall<D>>& walls, const Vec<D>& x) {
  const auto found = std::find_if(walls.begin(), walls.end(), [&](const auto& w) { return w.holds(x); });
  return found == walls.end() ? -1 : found - walls.begin();
}

/// Planes: point, normal into the side of the particles. Sphere insides: center, radius. Motion "fixed", "velocity"
/// (constant), "force" (planes: along the normal under a force, positive towards the particles, with a servo mass).
/// In two dimensions planes are lines and spheres circles. Throws InputError.
template <int D>
std::vector<SceneWall<D>> read_walls(const SceneTable& root, const std::vector<Material>& materials);

/// Table [cell]: `size` (or "file": the box of [particles] file), `periodic`, `shear_rate` (the top moves along x, the
/// velocity gradient d vx/dy; images move with it, as between Lees-Edwards boundaries). Without the table: open
/// everywhere. Throws InputError.
template <int D>
Cell<D> read_cell(const SceneTable& root, const SceneBodies<D>& bodies);

/// A grain may meet each neighbour under one image alone: throws InputError when a periodic axis is not wider than two
/// diameters of the largest grain, with what its laws reach and some room for the margins of neighbour lists (skin.h).
template <int D>
void require_wide_cell(const SceneTable& root, const System<D>& system);

}  // namespace softgrain
