#include "macrosim/macro_snapshot.h"

#include "common/dynamics/system_snapshot.h"

namespace softgrain {

Snapshot macro_snapshot(const MacroSystem& macro, const MacroPacking& packing) {
  Snapshot s = snapshot_of(macro.system);
  const bool resolved = macro.inner_grains > 0;
  s.kind = resolved ? SnapshotKind::twin : SnapshotKind::macro;
  s.has_velocity = false;  // left over from relaxing
  for (std::size_t k = 0; k < s.particles.size(); ++k) {
    SnapshotParticle& p = s.particles[k];
    p.body = macro.body[k];
    p.velocity = {};
    if (packing.bodies[static_cast<std::size_t>(p.body)].soft)
      p.role = resolved ? ParticleRole::inner : ParticleRole::soft;
  }
  for (std::size_t k = 0; k < s.walls.size(); ++k)
    if (s.walls[k].shape == WallShape::sphere_inside) s.walls[k].body = macro.body[s.particles.size() + k];
  return s;
}

}  // namespace softgrain
