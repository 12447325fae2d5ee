#include "microsim/powder/powder_state_io.h"

#include <numbers>
#include <string>

#include "common/core/error.h"
#include "common/data/attributes.h"
#include "common/data/rows.h"
#include "common/io/hdf5_file.h"
#include "common/packing/grading_scene.h"
#include "common/state/system_io.h"
#include "microsim/powder/powder_assembly.h"

namespace softgrain {

Snapshot powder_frames() {
  Snapshot form;
  form.kind = SnapshotKind::powder;
  form.length_unit = "a";
  form.force_unit = "F0";
  form.time_unit = "T0";
  form.dimension = 2;
  form.periodic = {true, true, false};
  return form;
}

void record_snapshot(Trajectory& t, const System<2>& s) {
  t.time.push_back(s.time);
  for (Slot k = 0; k < s.particles.grains; ++k) {
    const Vec<2>& x = s.particles.sphere[static_cast<std::size_t>(k)].x;
    t.position.insert(t.position.end(), {x[0], x[1], 0.0});
  }
  const Matrix<2>& e = s.cell.edges;
  t.cell_edges.insert(t.cell_edges.end(), {e[0][0], e[0][1], 0.0, e[1][0], e[1][1], 0.0, 0.0, 0.0, 0.0});
}

namespace {

/// As version 0.2 wrote them: a group "snapshots" with a group 0, 1, ... for each, without units.
Trajectory read_grouped_snapshots(const h5::Group& all) {
  Trajectory t;
  for (std::size_t k = 0; all.has(std::to_string(k)); ++k) {
    const h5::Group one = all.open(std::to_string(k));
    const auto positions = one.doubles("positions");
    const auto cell = one.doubles("cell");
    if (positions.size() != 2 * one.doubles("radii").size() || cell.size() != 2)
      throw IoError("powder: snapshot " + std::to_string(k) + " has arrays that do not fit together");
    t.time.push_back(one.number("time"));
    for (std::size_t n = 0; n < positions.size(); n += 2)
      t.position.insert(t.position.end(), {positions[n], positions[n + 1], 0.0});
    t.cell_edges.insert(t.cell_edges.end(), {cell[0], 0.0, 0.0, 0.0, cell[1], 0.0, 0.0, 0.0, 0.0});
  }
  return t;
}

}  // namespace

Trajectory read_snapshots(const h5::Group& group) {
  if (group.has("snapshots")) return read_grouped_snapshots(group.open("snapshots"));
  return group.has("trajectory") ? read_trajectory(group.open("trajectory"), powder_frames()) : Trajectory{};
}

void fields(auto&& visit, Of<PowderSpec> auto& s) {
  visit("disks", s.disks);
  visit("diameter_min", s.diameter_min);
  visit("solid_fraction", s.solid_fraction);
  visit("stiffness", s.stiffness);
  visit("stiffness_ratio", s.stiffness_ratio);
  visit("friction", s.friction);
  visit("damping", s.damping);
  visit("cohesive", s.cohesive);
  visit("range", s.range);
  visit("rolling", s.rolling);
  visit("rolling_stiffness", s.rolling_stiffness);
  visit("rolling_friction", s.rolling_friction);
  visit("pressure", s.pressure);
}

namespace {

/// V0 of each component. Files of version 0.2.0 and earlier have "start_speed" instead, of |v|.
constexpr const char* kComponentSpeed = "start_speed_per_component";

}  // namespace

void write_powder_spec(const h5::Group& group, const PowderSpec& spec) {
  write_attributes(group, spec);
  group.attribute(kComponentSpeed, spec.start_speed);
  if (spec.sizes) group.attribute("sizes", spec.sizes->text());
}

PowderSpec read_powder_spec(const h5::Group& group) {
  PowderSpec spec;
  read_attributes(group, spec);
  spec.start_speed = group.has_attribute(kComponentSpeed) ? group.number(kComponentSpeed)
                                                          : group.number("start_speed") / std::numbers::sqrt2;
  if (group.has_attribute("sizes")) spec.sizes = stored_grading(group.text("sizes"), 2);
  return spec;
}

namespace {

// Rows of a point of the course and of a stage, with the words for people that stand beside them.

constexpr const char* kPointWords = "phase, time [T0], Phi, z, kinetic energy per disk, stress x, stress y";
constexpr auto kPointRow = [](auto&& visit, auto& p) {
  visit(p.phase);
  visit(p.time);
  visit(p.fraction);
  visit(p.coordination);
  visit(p.kinetic);
  visit(p.stress);
};

constexpr const char* kStageWords =
    "phase, imposed pressure, time [T0], Phi, z, mean repulsive and mean tensile force, bulk and shear modulus";
constexpr auto kStageRow = [](auto&& visit, auto& s) {
  visit(s.phase);
  fields([&visit](const char*, auto& member, const auto&...) { visit(member); }, s);
};

}  // namespace

/// The numbers of a state beside its lists.
void fields(auto&& visit, Of<PowderState> auto& s) {
  visit("phase", s.phase);
  visit("phase_start", s.phase_start);
  visit("phase_edge_x", s.phase_edge.v[0]);
  visit("phase_edge_y", s.phase_edge.v[1]);
  visit("stiffness", s.stiffness);
  visit("phase_stiffness", s.phase_stiffness);
  visit("settling", s.settling);
  visit("still_since", s.still_since);
  visit("still_edge_x", s.still_edge.v[0]);
  visit("still_edge_y", s.still_edge.v[1]);
  visit("still_contacts", s.still_contacts);
  visit("pictured", s.pictured);
}

void write_powder_state(const h5::Group& group, const PowderState& state) {
  group.attribute("columns", kPointWords);
  write_rows(group, "course", state.points, kPointRow);
  group.attribute("stage_columns", kStageWords);
  write_rows(group, "stages", state.stages, kStageRow);
  write_attributes(group.create("progress"), state);
  if (!state.snapshots.time.empty()) write_trajectory(group.create("trajectory"), state.snapshots, powder_frames());
  write_system(group.create("system"), state.system);
}

std::vector<PowderPoint> read_course(const h5::Group& group) {
  return records_in_rows<PowderPoint>(group, "course", kPointRow);
}

std::vector<PowderStage> read_stages(const h5::Group& group) {
  if (!group.has("stages")) return {};
  return records_in_rows<PowderStage>(group, "stages", kStageRow);
}

void read_powder_state(const h5::Group& group, PowderState& state) {
  state.points = read_course(group);
  state.stages = read_stages(group);
  read_attributes(group.open("progress"), state);
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
