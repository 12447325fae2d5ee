// The states that grain_box.h5 holds.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "microsim/grain_box/record.h"
#include "pipelines/kinds/grain_box/scene.h"

namespace softgrain {

namespace {

/// Point of a contact. For two spheres it lies in the plane of the circle in which they meet.
Vec3 contact_point(const GrainPack& pack, const PackContact& c) {
  const auto i = static_cast<std::size_t>(c.i);
  const double ri = pack.radius[i];
  double arm = ri - c.overlap;
  if (c.j < pack.grains()) {
    const double rj = pack.radius[static_cast<std::size_t>(c.j)];
    const double distance = ri + rj - c.overlap;
    arm = 0.5 * (distance + (ri - rj) * (ri + rj) / distance);
  }
  return pack.position[i] - c.normal * arm;
}

void add_bodies(const GrainPack& pack, Snapshot& s) {
  for (std::size_t k = 0; k < pack.radius.size(); ++k) {
    SnapshotParticle p;
    p.position = pack.position[k];
    p.radius = pack.radius[k];
    p.id = p.body = static_cast<std::int64_t>(k);
    s.particles.push_back(p);
  }
  for (const PackWall& w : pack.walls) {
    SnapshotWall wall;
    wall.point = w.point;
    wall.normal = w.normal;
    s.walls.push_back(wall);
  }
}

Snapshot picture_of(const GrainBoxResult& result) {
  const GrainPack& pack = result.state.pack;
  Snapshot s;
  s.kind = SnapshotKind::grain_box;
  s.series = result.spec.name;
  add_bodies(pack, s);
  s.has_contacts = true;
  for (const PackContact& c : pack.contacts) {
    SnapshotContact out;
    out.i = c.i;
    out.j = c.j;
    out.from = pack.position[static_cast<std::size_t>(c.i)];
    out.point = contact_point(pack, c);
    out.to = c.j < pack.grains() ? pack.position[static_cast<std::size_t>(c.j)] : out.point;
    out.force = c.normal * c.normal_force + c.tangential_force;
    out.normal_force = c.normal_force;
    s.contacts.push_back(out);
  }
  if (!result.state.points.empty()) {
    const Vec3& strain = result.state.points.back().strain;
    s.strain = *std::max_element(strain.v.begin(), strain.v.end());
    s.frame = static_cast<std::int64_t>(result.state.points.size()) - 1;
  }
  s.label = fmt::format("grain box {}, strain {:.4g}", result.spec.name, std::isnan(s.strain) ? 0.0 : s.strain);
  return s;
}

}  // namespace

void visit_grain_boxes(const std::string& path, SnapshotChoice /*choice*/, const VisitSnapshot& visit) {
  for (const GrainBoxResult& result : load_grain_boxes(path)) visit(picture_of(result));
}

}  // namespace softgrain
