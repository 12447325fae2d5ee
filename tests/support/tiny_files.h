// One small file of every kind that the program reads back, for tests that damage them. All from fixed numbers.
#pragma once

#include <string>

#include "common/contact/make_laws.h"
#include "common/data/macro_result.h"
#include "common/data/snapshot_io.h"
#include "common/neighbours/verlet_list.h"
#include "common/state/checkpoint.h"
#include "common/state/system_io.h"
#include "microsim/grain_box/record.h"
#include "microsim/particles/particles_run.h"
#include "microsim/powder/powder_assembly.h"
#include "microsim/powder/powder_state_io.h"
#include "tests/support/synthetic_law.h"
#include "tests/support/synthetic_multi_contact.h"
#include "tests/support/synthetic_run.h"

namespace softgrain::test {

inline constexpr const char* kTinyCheckpointScene = "a scene";

inline void tiny_measurements(const std::string& path) {
  SyntheticOptions o;
  o.packings = 3;
  o.deltas = {0.1, 0.2, 0.3};
  save(synthetic(o), path);
}

inline void tiny_multi_contact(const std::string& path) {
  const MultiContactModel model = multi_contact_model(synthetic::multi_contact_law(LawForm::pair));
  synthetic::MultiContactOptionsKnown o;
  o.packings = 2;
  o.points = 3;
  save_multi_contact(synthetic::multi_contact_measurements(
                         model,
                         {synthetic::multi_contact_configuration(Arrangement::one, PartnerKind::plane, 0.0, 0.3),
                          synthetic::multi_contact_configuration(Arrangement::opposite, PartnerKind::plane, 0.0, 0.2,
                                                                 MultiContactMove::slide)},
                         o),
                     path);
}

inline void tiny_macro(const std::string& path) {
  std::vector<MacroCurve> curves{synthetic::macro_curve("law", 0, 0.8, 4),
                                 synthetic::macro_curve("shelled", 0, 1.0, 4)};
  for (MacroCurve& c : curves) {
    c.stress_y = c.stress_lateral;
    c.body_forces = {0.5, 1.0, 2.0};
  }
  save_macro(curves, path);
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

/// Two spheres that meet on a plane, with all their frames.
inline void tiny_particles_run(const std::string& path) {
  const ParticlesScene scene = read_particles_scene(Scene::parse(R"(kind = "particles"
[material.glass]
density = 2500.0
E = 1e6
nu = 0.2
[[contact]]
pair = ["glass", "glass"]
law = "hertz-tsuji"
restitution = 0.9
mu = 0.3
[[particle]]
material = "glass"
radius = 0.1
position = [0.0, 0.0, 0.0999]
[[particle]]
material = "glass"
radius = 0.1
position = [0.1999, 0.0, 0.0999]
velocity = [-0.1, 0.0, 0.0]
[[wall]]
shape = "plane"
point = [0.0, 0.0, 0.0]
normal = [0.0, 0.0, 1.0]
material = "glass"
[time]
end = 1e-3
step = 1e-4
[output]
every = 2e-4
)",
                                                                 "tiny.toml"));
  save_particles_run(path, scene, run_particles(scene, {}), build_provenance());
}

/// Three spheres in a row beside a plane, in contact, as a run keeps them.
inline void tiny_states(const std::string& path) {
  Snapshot s;
  s.kind = SnapshotKind::macro;
  s.series = "law-0";
  s.label = "law run, sample 0, strain 0.1";
  s.strain = 0.1;
  for (int k = 0; k < 3; ++k) {
    SnapshotParticle p;
    p.position = {{0.19 * k, 0.0, 0.1}};
    p.radius = 0.1;
    p.id = p.body = k;
    s.particles.push_back(p);
  }
  s.walls.push_back({WallShape::plane, {}, {{0.0, 0.0, 1.0}}, 0.0, -1});
  s.has_contacts = true;
  for (std::int32_t k = 0; k < 2; ++k) {
    SnapshotContact c;
    c.i = k;
    c.j = k + 1;
    c.from = s.particles[static_cast<std::size_t>(k)].position;
    c.to = s.particles[static_cast<std::size_t>(k) + 1].position;
    c.point = (c.from + c.to) * 0.5;
    c.force = {{-2.0, 0.0, 0.0}};
    c.normal_force = 2.0;
    s.contacts.push_back(c);
  }
  save_snapshots({s, s}, path, build_provenance());
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
  state.stages.resize(1);
  record_snapshot(state.snapshots, state.system);
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
