// The table [cell].
#pragma once

#include "common/core/cell.h"
#include "common/io/scene.h"
#include "microsim/particles/scene_bodies.h"

namespace softgrain {

/// Table [cell]: `size` (or "file": the box of [particles] file), `periodic`, `shear_rate` (the top moves along x, the
/// velocity gradient d vx/dy; images move with it, as between Lees-Edwards boundaries). Without the table: open
/// everywhere. Throws BadInput.
template <int D>
Cell<D> read_cell(const SceneTable& root, const SceneBodies<D>& bodies);

/// A grain may meet each neighbour under one image alone: throws BadInput when a periodic axis is narrower than two
/// diameters of the largest grain.
template <int D>
void require_wide_cell(const SceneTable& root, const Particles<D>& particles, const Cell<D>& cell);

}  // namespace softgrain
