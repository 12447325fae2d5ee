#include "pipelines/snapshots/snapshots_of_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/dynamics/system_snapshot.h"
#include "microsim/grain_box/record.h"
#include "microsim/powder/powder_state_io.h"

namespace softgrain {

namespace {

using Visit = std::function<void(const Snapshot&)>;

void name_units(Snapshot& s, const PowderSpec& spec) {
  s.kind = SnapshotKind::powder;
  s.length_unit = "a";
  s.force_unit = spec.cohesive ? "F0" : "P a";
  s.time_unit = "T0";
}

Snapshot picture_of(const PowderSnapshot& from, const PowderSpec& spec) {
  Snapshot s;
  name_units(s, spec);
  s.dimension = 2;
  s.time = from.time;
  for (std::size_t k = 0; k < 2; ++k) {
    s.periodic[k] = true;
    s.cell_edges[k].v[k] = from.lengths.v[k];
  }
  for (const Sphere<2>& disk : from.disks) {
    SnapshotParticle p;
    p.position = {{disk.x[0], disk.x[1], 0.0}};
    p.radius = disk.r;
    p.id = p.body = static_cast<std::int64_t>(s.particles.size());
    s.particles.push_back(p);
  }
  return s;
}

/// The last picture of an assembly may be its end, which is told with contacts instead.
void visit_sample(const h5::Group& group, const PowderSpec& spec, std::size_t sample, SnapshotChoice choice,
                  const Visit& visit) {
  Snapshot last = snapshot_of(read_powder_system(group, spec));
  name_units(last, spec);
  last.time = group.open("system").number("time");
  std::vector<Snapshot> states;
  if (choice == SnapshotChoice::all)
    for (const PowderSnapshot& picture : read_snapshots(group))
      if (picture.time < last.time) states.push_back(picture_of(picture, spec));
  states.push_back(std::move(last));
  for (std::size_t k = 0; k < states.size(); ++k) {
    states[k].series = fmt::format("sample_{}", sample);
    states[k].label = fmt::format("powder, sample {}, time {:.4g} T0", sample, states[k].time);
    states[k].frame = static_cast<std::int64_t>(k);
    visit(states[k]);
  }
}

/// Of two spheres the plane of the circle in which they meet.
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

void visit_powder(const std::string& path, SnapshotChoice choice, const Visit& visit) {
  const h5::Group root = h5::open_file(path);
  const PowderSpec spec = read_powder_spec(root.open("spec"));
  for (std::size_t k = 0; root.has(fmt::format("sample_{}", k)); ++k)
    visit_sample(root.open(fmt::format("sample_{}", k)), spec, k, choice, visit);
}

void visit_grain_boxes(const std::string& path, SnapshotChoice /*choice*/, const Visit& visit) {
  for (const GrainBoxResult& result : load_grain_boxes(path)) visit(picture_of(result));
}

}  // namespace softgrain
