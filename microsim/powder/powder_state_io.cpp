#include "microsim/powder/powder_state_io.h"

#include <string>

#include "common/io/attribute_members.h"
#include "common/state/system_io.h"

namespace softgrain {

namespace {

constexpr std::size_t kColumns = 7;

/// Calls item(name, member) for each number of a state, the same list for both directions.
template <class State, class Item>
void for_progress(State& s, const Item& item) {
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
  std::vector<double> rows;
  for (const PowderPoint& p : state.points)
    rows.insert(rows.end(), {static_cast<double>(p.phase), p.time, p.fraction, p.coordination, p.kinetic, p.stress[0],
                             p.stress[1]});
  group.attribute("columns", std::string("phase, time [T0], Phi, z, kinetic energy per disk, stress x, stress y"));
  group.write("course", rows, {state.points.size(), kColumns});
  for_progress(state, AttributeWriter{group.create("progress")});
  write_snapshots(group, state.snapshots);
  write_system(group.create("system"), state.system);
}

void read_powder_state(const h5::Group& group, PowderState& state) {
  const auto rows = group.doubles("course");
  state.points.clear();
  for (std::size_t k = 0; k + kColumns <= rows.size(); k += kColumns)
    state.points.push_back({static_cast<std::int64_t>(rows[k]),
                            rows[k + 1],
                            rows[k + 2],
                            rows[k + 3],
                            rows[k + 4],
                            {{rows[k + 5], rows[k + 6]}}});
  for_progress(state, AttributeReader{group.open("progress")});
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
