// The states that powder.h5 holds.
#include <fmt/format.h>

#include "common/state/system_io.h"
#include "microsim/powder/powder_state_io.h"
#include "pipelines/kinds/cohesive_powder/scene.h"

namespace softgrain {

namespace {

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
                  const VisitSnapshot& visit) {
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

}  // namespace

void visit_powder(const std::string& path, SnapshotChoice choice, const VisitSnapshot& visit) {
  const h5::Group root = h5::open_file(path);
  const PowderSpec spec = read_powder_spec(root.open("spec"));
  for (std::size_t k = 0; root.has(fmt::format("sample_{}", k)); ++k)
    visit_sample(root.open(fmt::format("sample_{}", k)), spec, k, choice, visit);
}

}  // namespace softgrain
