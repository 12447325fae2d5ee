// States as pictures: to files and back, which recorded points are kept, contacts across a periodic boundary.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/core/error.h"
#include "common/core/particles.h"
#include "common/data/snapshot_io.h"
#include "common/dynamics/force_pass.h"
#include "common/neighbours/spatial_order.h"
#include "common/state/system_io.h"
#include "tests/support/hdf5_edit.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

/// Four grains in a periodic box, of which two touch inside and two across the x boundary, on a plane.
System3 periodic_system() {
  System3 s;
  s.materials = {{"glass", 2500.0, 1e7, 0.25, false}};
  s.laws = LawSet(1);
  s.laws.set(0, 0, hertz_law(HertzCoefficients::of(s.materials[0], s.materials[0], 0.4, 1.0), false));
  s.cell = box_cell<3>({{1.0, 1.0, 5.0}}, {true, true, false});
  const Vec3 places[] = {{{0.05, 0.5, 0.099}}, {{0.24, 0.5, 0.099}}, {{0.86, 0.5, 0.12}}, {{0.5, 0.06, 0.3}}};
  for (const Vec3& x : places) add_grain(s.particles, solid_sphere(x, 0.1, 2500.0, 0));
  NewBody<3> plane;
  add_plane(s.particles, plane, Vec3{{0.0, 0.0, 1.0}});
  return s;
}

TEST(Snapshot, EndsOfContactsAreOneContactApart) {
  System3 s = periodic_system();
  const Snapshot shot = snapshot_of(s);
  ASSERT_EQ(shot.particles.size(), 4U);
  ASSERT_EQ(shot.walls.size(), 1U);
  ASSERT_EQ(shot.contacts.size(), 4U);  // 0-1, 0-2 across the boundary, 0 and 1 on the plane
  EXPECT_TRUE(shot.periodic[0] && shot.periodic[1] && !shot.periodic[2]);
  int across = 0;
  for (const SnapshotContact& c : shot.contacts) {
    const auto i = static_cast<std::size_t>(c.i);
    EXPECT_EQ(c.from, shot.particles[i].position);
    EXPECT_GT(c.normal_force, 0.0);
    if (c.j >= 4) {
      EXPECT_EQ(c.j, 4);
      EXPECT_EQ(c.to, c.point);
      EXPECT_NEAR(c.point[2], 0.0, 2e-3);
      continue;
    }
    const Vec3 expected = shot.particles[static_cast<std::size_t>(c.j)].position + c.shift;
    EXPECT_NEAR(norm(c.to - expected), 0.0, 1e-15);
    EXPECT_LT(norm(c.to - c.from), 0.2);
    EXPECT_GT(norm(c.to - c.from), 0.18);
    EXPECT_LT(norm(c.point - c.from), 0.1);
    if (c.shift != Vec3{}) {
      ++across;
      EXPECT_EQ(c.shift, (Vec3{{-1.0, 0.0, 0.0}}));
    }
  }
  EXPECT_EQ(across, 1);
}

/// Sums of the contact forces of a picture are the forces of a loop pass, in any order of the grains.
TEST(Snapshot, ForcesAddUpAlsoInAnotherOrder) {
  System3 s = periodic_system();
  const Snapshot plain = snapshot_of(s);
  reorder_grains(s, {2, 0, 3, 1});
  const Snapshot shot = snapshot_of(s);
  force_pass(s, 0.0);
  const auto slots = slots_by_id(s.particles);
  std::vector<Vec3> sums(4);
  ASSERT_EQ(shot.contacts.size(), plain.contacts.size());
  for (std::size_t k = 0; k < shot.contacts.size(); ++k) {
    const SnapshotContact& c = shot.contacts[k];
    EXPECT_EQ(c.i, plain.contacts[k].i);
    EXPECT_EQ(c.j, plain.contacts[k].j);
    EXPECT_NEAR(norm(c.from - plain.contacts[k].from), 0.0, 1e-15);
    EXPECT_NEAR(norm(c.to - plain.contacts[k].to), 0.0, 1e-15);
    EXPECT_NEAR(norm(c.force - plain.contacts[k].force), 0.0, 1e-9 * norm(c.force));
    sums[static_cast<std::size_t>(c.i)] += c.force;
    if (c.j < 4) sums[static_cast<std::size_t>(c.j)] -= c.force;
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3 force = s.particles.force[static_cast<std::size_t>(slots[k])];
    EXPECT_NEAR(norm(sums[k] - force), 0.0, 1e-12 * (1.0 + norm(force)));
    EXPECT_EQ(shot.particles[k].position, plain.particles[k].position);
  }
}

TEST(Snapshot, ComesBackFromAFile) {
  const TemporaryDirectory directory;
  Snapshot shot = snapshot_of(periodic_system());
  shot.kind = SnapshotKind::twin;
  shot.series = "shelled-0";
  shot.label = "a label";
  shot.frame = 7;
  shot.strain = 0.125;
  shot.particles[1].role = ParticleRole::inner;
  shot.particles[1].body = 12;
  shot.walls[0].body = 3;
  shot.particles[2].spin = {{0.5, -0.25, 1.0 / 3.0}};
  for (const SnapshotParticle& p : shot.particles) EXPECT_GT(p.mass, 0.0);
  Snapshot bare = shot;
  bare.particles[0].mass = Snapshot::kNone;
  bare.has_contacts = bare.has_velocity = false;
  bare.contacts.clear();
  save_snapshots({shot, bare}, directory.file("states.h5"), build_provenance());
  const auto back = read_snapshot_list(open_snapshots(directory.file("states.h5")));
  ASSERT_EQ(back.size(), 2U);
  const Snapshot& b = back[0];
  EXPECT_EQ(b.kind, SnapshotKind::twin);
  EXPECT_EQ(b.series, "shelled-0");
  EXPECT_EQ(b.label, "a label");
  EXPECT_EQ(b.frame, 7);
  EXPECT_EQ(b.moment(), 0.125);
  EXPECT_EQ(b.moment_name(), Moment::strain);
  EXPECT_TRUE(b.has_velocity);
  EXPECT_EQ(b.cell_edges, shot.cell_edges);
  EXPECT_EQ(b.periodic, shot.periodic);
  ASSERT_EQ(b.particles.size(), 4U);
  EXPECT_EQ(b.particles[1].role, ParticleRole::inner);
  EXPECT_EQ(b.particles[1].body, 12);
  EXPECT_EQ(b.particles[2].position, shot.particles[2].position);
  EXPECT_EQ(b.particles[2].spin, shot.particles[2].spin);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(b.particles[k].mass, shot.particles[k].mass);
    EXPECT_TRUE(std::isnan(back[1].particles[k].mass)) << "kept where all are known";
  }
  ASSERT_EQ(b.walls.size(), 1U);
  EXPECT_EQ(b.walls[0].normal, shot.walls[0].normal);
  EXPECT_EQ(b.walls[0].body, 3);
  ASSERT_EQ(b.contacts.size(), shot.contacts.size());
  for (std::size_t k = 0; k < b.contacts.size(); ++k) {
    EXPECT_EQ(b.contacts[k].j, shot.contacts[k].j);
    EXPECT_EQ(b.contacts[k].to, shot.contacts[k].to);
    EXPECT_EQ(b.contacts[k].force, shot.contacts[k].force);
    EXPECT_EQ(b.contacts[k].shift, shot.contacts[k].shift);
  }
  EXPECT_FALSE(back[1].has_contacts);
  EXPECT_FALSE(back[1].has_velocity);
}

TEST(Snapshot, DamagedContactsAreFound) {
  const TemporaryDirectory directory;
  const Snapshot shot = snapshot_of(periodic_system());
  const auto written = [&](const char* name, std::vector<SnapshotContact> contacts) {
    h5::AtomicFile file(directory.file(name));
    write_snapshot_contacts(file.root().create("c"), contacts, shot, contacts.size());
    file.commit();
    return h5::open_file(directory.file(name)).open("c");
  };
  EXPECT_EQ(read_snapshot_contacts(written("good.h5", shot.contacts), {4, 5}, Snapshot{}).size(), 4U);
  EXPECT_THROW((void)read_snapshot_contacts(written("a.h5", shot.contacts), {4, 4}, Snapshot{}), IoError);
  auto negative = shot.contacts;
  negative[0].i = -1;
  EXPECT_THROW((void)read_snapshot_contacts(written("b.h5", negative), {4, 5}, Snapshot{}), IoError);
  auto lost = shot.contacts;
  lost[1].force[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)read_snapshot_contacts(written("c.h5", lost), {4, 5}, Snapshot{}), IoError);
}

TEST(Snapshot, KeptPointsAreSpreadAndEndWithTheLast) {
  const auto kept = [](std::int64_t points, std::int64_t wanted) {
    std::vector<std::int64_t> out;
    for (std::int64_t k = -1; k <= points; ++k)
      if (is_snapshot(k, points, wanted)) out.push_back(k);
    return out;
  };
  EXPECT_EQ(kept(31, 4), (std::vector<std::int64_t>{0, 10, 20, 30}));
  EXPECT_EQ(kept(31, 1), (std::vector<std::int64_t>{30}));
  EXPECT_EQ(kept(3, 2), (std::vector<std::int64_t>{0, 2}));
  EXPECT_EQ(kept(1, 4), (std::vector<std::int64_t>{0}));
  EXPECT_EQ(kept(5, 0).size(), 0U);
  for (const std::int64_t points : {2, 7, 100, 101, 977})
    for (const std::int64_t wanted : {1, 2, 3, 5, 50, 100, 1000}) {
      const auto k = kept(points, wanted);
      ASSERT_EQ(static_cast<std::int64_t>(k.size()), std::min(points, wanted)) << points << " " << wanted;
      EXPECT_EQ(k.back(), points - 1);
      std::int64_t widest = 0;
      for (std::size_t n = 1; n < k.size(); ++n) widest = std::max(widest, k[n] - k[n - 1]);
      EXPECT_LE(widest, (points - 1) / std::max<std::int64_t>(std::min(points, wanted) - 1, 1) + 1);
    }
}

}  // namespace
