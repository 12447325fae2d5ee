#include "microsim/soft_snapshot.h"

#include "common/dynamics/system_snapshot.h"

namespace softgrain {

Snapshot soft_snapshot(const SoftExperiment& e) {
  Snapshot s = snapshot_of(e.system);
  s.kind = SnapshotKind::soft_particle;
  s.has_velocity = false;  // left over from relaxing
  s.overlap = e.normal_overlap / e.spec.shell_radius;
  for (std::size_t k = 0; k < s.particles.size(); ++k) {
    s.particles[k].role = ParticleRole::inner;
    s.particles[k].body = k < static_cast<std::size_t>(e.first_grains) ? 0 : 1;
    s.particles[k].velocity = {};
  }
  for (std::size_t k = 0; k < s.walls.size(); ++k)
    if (s.walls[k].shape == WallShape::sphere_inside) s.walls[k].body = static_cast<std::int64_t>(k);
  return s;
}

}  // namespace softgrain
