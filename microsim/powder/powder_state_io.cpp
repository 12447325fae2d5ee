#include "microsim/powder/powder_state_io.h"

#include <string>

#include "common/data/fields.h"
#include "common/io/attribute_members.h"
#include "common/state/system_io.h"

namespace softgrain {

void fields(auto&& visit, Of<PowderPoint> auto& p) {
  visit("phase", p.phase, "1");
  visit("time", p.time, "T0");
  visit("fraction", p.fraction, "1");
  visit("coordination", p.coordination, "1");
  visit("kinetic", p.kinetic, "1");
  visit("stress_x", p.stress.v[0], "1");
  visit("stress_y", p.stress.v[1], "1");
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
  fields(AttributeWriter{group.create("progress")}, state);
  write_snapshots(group, state.snapshots);
  write_system(group.create("system"), state.system);
}

void read_powder_state(const h5::Group& group, PowderState& state) {
  state.points = records_of<PowderPoint>(group.doubles("course"));
  fields(AttributeReader{group.open("progress")}, state);
  state.snapshots = read_snapshots(group);
  read_system(group.open("system"), state.system);
}

System<2> read_powder_system(const h5::Group& group, const PowderSpec& spec) {
  System<2> s;
  s.materials = {{"disk", 1.0, 1.0, 0.3, false}};
  s.laws = LawSet(1);
  s.laws.set(0, 0, powder_law(spec));
  read_system(group.open("system"), s);
  return s;
}

}  // namespace softgrain
