// Particles of a scene that are drawn by a distribution of sizes and placed at random.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/core/particles.h"
#include "common/packing/grading.h"
#include "microsim/particles/scene_walls.h"

namespace softgrain {

template <int D>
struct DrawnParticles {
  std::vector<Vec<D>> position;
  std::vector<double> radius;  ///< largest first
  std::optional<Grading> sizes;
  std::uint64_t seed = 1;  ///< they were drawn with
};

/// `count`, `sizes`, `seed` (or that of the root; `seed` of the command line goes first), `low` and `high` (corners of
/// the box of places; without them [cell], whose periodic axes are closed) of the table `t` = [particles]: largest
/// first at random places, without overlap with each other, with `others` or with walls. Throws InputError when one
/// finds none.
template <int D>
DrawnParticles<D> read_drawn(const SceneTable& root, const SceneTable& t, const std::vector<SceneWall<D>>& walls,
                             const std::vector<NewBody<D>>& others, const std::optional<std::uint64_t>& seed);

}  // namespace softgrain
