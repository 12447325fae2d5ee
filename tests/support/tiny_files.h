// One small file of every kind that the program reads back, for tests that damage them. All from fixed numbers.
#pragma once

#include <string>

#include "common/contact/crowd_from_table.h"
#include "common/data/macro_result.h"
#include "common/neighbours/verlet_list.h"
#include "common/state/checkpoint.h"
#include "common/state/system_io.h"
#include "microsim/grain_box/record.h"
#include "microsim/powder/powder_spec_io.h"
#include "microsim/powder/powder_state_io.h"
#include "tests/support/synthetic_crowd.h"
#include "tests/support/synthetic_law.h"
#include "tests/support/synthetic_run.h"

namespace softgrain::test {

inline constexpr const char* kTinyCheckpointScene = "a scene";

inline void tiny_measurements(const std::string& path) {
  SyntheticOptions o;
  o.packings = 3;
  o.deltas = {0.1, 0.2, 0.3};
  save(synthetic(o), path);
}

inline void tiny_crowd(const std::string& path) {
  const CrowdModel model = crowd_model(synthetic::crowd_law("pair"));
  synthetic::CrowdOptionsKnown o;
  o.packings = 2;
  o.points = 3;
  save_crowd(
      synthetic::crowd_measurements(model,
                                    {synthetic::crowd_configuration("one", PartnerKind::plane, 0.0, 0.3),
                                     synthetic::crowd_configuration("opposite", PartnerKind::plane, 0.0, 0.2, "slide")},
                                    o),
      path);
}

inline void tiny_macro(const std::string& path) {
  save_macro({synthetic::macro_curve("law", 0, 0.8, 4), synthetic::macro_curve("shelled", 0, 1.0, 4)}, path);
}

/// Two grains between two walls, two points of the course, one failure on the way.
inline GrainBoxResult tiny_box() {
  GrainBoxResult result;
  result.usable = true;
  result.spec.name = "pack";
  GrainBoxState& state = result.state;
  state.phase = BoxPhase::done;
  state.points.resize(2);
  state.points[1].phase = BoxPhase::loading;
  state.failures.resize(1);
  GrainPack& pack = state.pack;
  pack.position = {{{0.0, 0.0, 1e-4}}, {{0.0, 0.0, 2.9e-4}}};
  pack.radius = {1e-4, 1e-4};
  pack.youngs_modulus = {7e10, 7e10};
  pack.poisson_ratio = {0.2, 0.2};
  pack.walls.resize(2);
  pack.contacts.resize(2);
  pack.contacts[0].j = 1;
  pack.contacts[1].j = 2;
  return result;
}

inline void tiny_grain_boxes(const std::string& path) { save_grain_boxes(path, {tiny_box()}, build_provenance()); }

/// Twenty disks at the start.
inline void tiny_powder(const std::string& path) {
  PowderSpec spec;
  spec.disks = 20;
  spec.solid_fraction = 0.3;
  spec.stiffness = 1e3;
  PowderState state = start_powder(spec, 1, 0);
  rebuild_neighbours(state.system);
  state.points.resize(2);
  state.snapshots = {powder_snapshot(state.system)};
  h5::AtomicFile file(path);
  write_powder_spec(file.root().create("spec"), spec);
  const h5::Group group = file.root().create("sample_0");
  group.attribute("usable", std::int64_t{1});
  group.attribute("reason", "");
  write_powder_state(group, state);
  file.commit();
}

/// Laws and materials of the system in tiny_checkpoint().
inline System3 tiny_system() {
  System3 s;
  s.materials = {{"glass", 2500.0, 1e7, 0.25, false}};
  s.laws = LawSet(1);
  s.laws.set(0, 0, hertz_law(HertzCoefficients::of(s.materials[0], s.materials[0], 0.4, 0.9), false));
  return s;
}

/// Three grains in a row, the outer ones in contact with the inner one, on a plane; springs as after some steps.
inline void tiny_checkpoint(const std::string& path) {
  System3 s = tiny_system();
  for (int k = 0; k < 3; ++k) {
    NewBody<3> grain;
    grain.x = {{0.199 * k, 0.01 * k, 0.0999}};
    grain.r = 0.1;
    grain.mass = 10.0;
    grain.inertia = 0.04;
    grain.velocity = {{0.0, 0.1 * k, 0.0}};
    add_grain(s.particles, grain);
  }
  add_plane(s.particles, NewBody<3>{}, Vec3{{0.0, 0.0, 1.0}});
  rebuild_neighbours(s);
  for (auto& spring : s.contacts.spring) spring = Vec3{{1e-6, 2e-6, -1e-6}};
  write_checkpoint(path, kTinyCheckpointScene, [&](const h5::Group& root) { write_system(root.create("system"), s); });
}

}  // namespace softgrain::test
