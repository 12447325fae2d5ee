#include "microsim/powder/powder_state_io.h"

#include <numbers>
#include <string>

#include "common/core/error.h"
#include "common/data/columns.h"
#include "common/data/fields.h"
#include "common/io/hdf5_file.h"
#include "common/packing/grading_scene.h"
#include "common/state/system_io.h"
#include "microsim/powder/powder_assembly.h"

namespace softgrain {

PowderSnapshot powder_snapshot(const System<2>& s) {
  return {s.time,
          {{s.cell.edges[0][0], s.cell.edges[1][1]}},
          {s.particles.sphere.begin(), s.particles.sphere.begin() + s.particles.grains}};
}

void write_snapshots(const h5::Group& group, const std::vector<PowderSnapshot>& snapshots) {
  if (snapshots.empty()) return;
  const h5::Group all = group.create("snapshots");
  for (std::size_t k = 0; k < snapshots.size(); ++k) {
    const PowderSnapshot& s = snapshots[k];
    std::vector<double> positions;
    std::vector<double> radii;
    for (const auto& d : s.disks) {
      positions.insert(positions.end(), {d.x[0], d.x[1]});
      radii.push_back(d.r);
    }
    const h5::Group one = all.create(std::to_string(k));
    one.attribute("time", s.time);
    one.write("positions", positions, {radii.size(), 2});
    one.write("radii", radii);
    one.write("cell", std::vector<double>{s.lengths[0], s.lengths[1]});
  }
}

std::vector<PowderSnapshot> read_snapshots(const h5::Group& group) {
  std::vector<PowderSnapshot> out;
  if (!group.has("snapshots")) return out;
  const h5::Group all = group.open("snapshots");
  for (std::size_t k = 0; all.has(std::to_string(k)); ++k) {
    const h5::Group one = all.open(std::to_string(k));
    const auto positions = one.doubles("positions");
    const auto radii = one.doubles("radii");
    const auto cell = one.doubles("cell");
    if (positions.size() != 2 * radii.size() || cell.size() != 2)
      throw IoError("powder: snapshot " + std::to_string(k) + " has arrays that do not fit together");
    PowderSnapshot s{one.number("time"), {{cell[0], cell[1]}}, {}};
    for (std::size_t n = 0; n < radii.size(); ++n)
      s.disks.push_back({{{positions[2 * n], positions[2 * n + 1]}}, radii[n]});
    out.push_back(std::move(s));
  }
  return out;
}

namespace {

// Members of a struct as attributes of a group, by one list of names for both directions.

/// item(name, member) writes the member.
struct AttributeWriter {
  const h5::Group& group;
  void operator()(const char* name, double value) const { group.attribute(name, value); }
  void operator()(const char* name, std::int64_t value) const { group.attribute(name, value); }
  void operator()(const char* name, bool value) const { group.attribute(name, std::int64_t{value ? 1 : 0}); }
};

/// item(name, member) reads it. Throws IoError when it is missing.
struct AttributeReader {
  const h5::Group& group;
  void operator()(const char* name, double& value) const { value = group.number(name); }
  void operator()(const char* name, std::int64_t& value) const { value = group.integer(name); }
  void operator()(const char* name, bool& value) const { value = group.integer(name) != 0; }
};

void fields(auto&& item, Of<PowderSpec> auto& s) {
  item("disks", s.disks);
  item("diameter_min", s.diameter_min);
  item("solid_fraction", s.solid_fraction);
  item("stiffness", s.stiffness);
  item("stiffness_ratio", s.stiffness_ratio);
  item("friction", s.friction);
  item("damping", s.damping);
  item("cohesive", s.cohesive);
  item("range", s.range);
  item("rolling", s.rolling);
  item("rolling_stiffness", s.rolling_stiffness);
  item("rolling_friction", s.rolling_friction);
  item("pressure", s.pressure);
}

}  // namespace

/// V0 of each component. Files of version 0.2.0 and earlier have "start_speed" instead, of |v|.
constexpr const char* kComponentSpeed = "start_speed_per_component";

void write_powder_spec(const h5::Group& group, const PowderSpec& spec) {
  fields(AttributeWriter{group}, spec);
  group.attribute(kComponentSpeed, spec.start_speed);
  if (spec.sizes) group.attribute("sizes", spec.sizes->text());
}

PowderSpec read_powder_spec(const h5::Group& group) {
  PowderSpec spec;
  fields(AttributeReader{group}, spec);
  spec.start_speed = group.has_attribute(kComponentSpeed) ? group.number(kComponentSpeed)
                                                          : group.number("start_speed") / std::numbers::sqrt2;
  if (group.has_attribute("sizes")) spec.sizes = stored_grading(group.text("sizes"), 2);
  return spec;
}

void fields(auto&& visit, Of<PowderPoint> auto& p) {
  visit("phase", p.phase, "1");
  visit("time", p.time, "T0");
  visit("fraction", p.fraction, "1");
  visit("coordination", p.coordination, "1");
  visit("kinetic", p.kinetic, "1");
  visit("stress_x", p.stress.v[0], "1");
  visit("stress_y", p.stress.v[1], "1");
}

void fields(auto&& visit, Of<PowderStage> auto& s) {
  visit("phase", s.phase, "1");
  visit("pressure", s.pressure, "1");
  visit("time", s.time, "T0");
  visit("fraction", s.fraction, "1");
  visit("coordination", s.coordination, "1");
  visit("mean_repulsive", s.mean_repulsive, "1");
  visit("mean_tensile", s.mean_tensile, "1");
  visit("bulk", s.bulk, "1");
  visit("shear", s.shear, "1");
}

namespace {

/// The numbers of a state beside its lists.
void fields(auto&& item, Of<PowderState> auto& s) {
  item("phase", s.phase);
  item("phase_start", s.phase_start);
  item("phase_edge_x", s.phase_edge.v[0]);
  item("phase_edge_y", s.phase_edge.v[1]);
  item("stiffness", s.stiffness);
  item("phase_stiffness", s.phase_stiffness);
  item("settling", s.settling);
  item("still_since", s.still_since);
  item("still_edge_x", s.still_edge.v[0]);
  item("still_edge_y", s.still_edge.v[1]);
  item("still_contacts", s.still_contacts);
  item("pictured", s.pictured);
}

}  // namespace

void write_powder_state(const h5::Group& group, const PowderState& state) {
  group.attribute("columns", std::string("phase, time [T0], Phi, z, kinetic energy per disk, stress x, stress y"));
  group.write("course", rows_of(state.points), {state.points.size(), columns_of<PowderPoint>().size()});
  group.attribute("stage_columns", std::string("phase, imposed pressure, time [T0], Phi, z, mean repulsive and mean "
                                               "tensile force, bulk and shear modulus"));
  group.write("stages", rows_of(state.stages), {state.stages.size(), columns_of<PowderStage>().size()});
  fields(AttributeWriter{group.create("progress")}, state);
  write_snapshots(group, state.snapshots);
  write_system(group.create("system"), state.system);
}

std::vector<PowderStage> read_stages(const h5::Group& group) {
  if (!group.has("stages")) return {};
  return records_of<PowderStage>(group.doubles("stages"));
}

void read_powder_state(const h5::Group& group, PowderState& state) {
  state.points = records_of<PowderPoint>(group.doubles("course"));
  state.stages = read_stages(group);
  fields(AttributeReader{group.open("progress")}, state);
  state.snapshots = read_snapshots(group);
  read_system(group.open("system"), state.system);
}

System<2> read_powder_system(const h5::Group& group, const PowderSpec& spec) {
  System<2> s;
  s.materials = {{"disk", 1.0, 1.0, 0.3, false}};
  s.laws = LawSet(1);
  PowderSpec now = spec;  // a sample that ended before its contacts stiffened has a stiffness of its own
  if (group.has("progress")) now.stiffness = group.open("progress").number("stiffness");
  s.laws.set(0, 0, powder_law(now));
  read_system(group.open("system"), s);
  return s;
}

}  // namespace softgrain
