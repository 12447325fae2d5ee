// Every kind of run keeps states that are those it reports of: forces in the pictures are the forces of the curves.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "common/core/error.h"
#include "common/data/macro_result.h"
#include "common/data/measurements.h"
#include "microsim/grain_box/record.h"
#include "pipelines/snapshots/snapshots.h"
#include "tests/support/every_kind.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/run_comparison.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

KindScene scene_of(const std::string& name) {
  for (const KindScene& s : every_kind())
    if (s.name == name) return s;
  return {};
}

std::map<std::string, std::vector<Snapshot>> series_of(const std::vector<Snapshot>& all) {
  std::map<std::string, std::vector<Snapshot>> out;
  for (const Snapshot& s : all) out[s.series].push_back(s);
  return out;
}

/// Of all contacts with a wall, on it.
Vec3 force_on_wall(const Snapshot& s, std::size_t wall) {
  Vec3 sum{};
  for (const SnapshotContact& c : s.contacts)
    if (static_cast<std::size_t>(c.j) == s.particles.size() + wall) sum -= c.force;
  return sum;
}

std::vector<std::size_t> planes_of(const Snapshot& s) {
  std::vector<std::size_t> planes;
  for (std::size_t k = 0; k < s.walls.size(); ++k)
    if (s.walls[k].shape == WallShape::plane) planes.push_back(k);
  return planes;
}

/// Mean axial stress on the z planes of a box.
double axial_stress(const Snapshot& s) {
  const auto p = planes_of(s);
  EXPECT_EQ(p.size(), 6U);
  const auto at = [&](std::size_t n) { return s.walls[p[n]].point; };
  const double area = (at(1)[0] - at(0)[0]) * (at(3)[1] - at(2)[1]);
  return 0.5 * (force_on_wall(s, p[5])[2] - force_on_wall(s, p[4])[2]) / area;
}

TEST(Snapshots, OfSoftParticlesCarryTheMeasuredForce) {
  const KindRuns runs(scene_of("soft-particle"));
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a"))), 0));
  const Measurements data = load_measurements(runs.out("a") + "/measurements.h5");
  const auto series = series_of(read_snapshots(runs.out("a")));
  ASSERT_EQ(series.size(), 3U);  // both kinds by least-work, the reference
  for (const PackingRun& run : data.runs) {
    if (run.packing != 0) continue;
    const auto& states = series.at(to_string(run.kind) + "-" + run.relaxation + "-0");
    ASSERT_EQ(states.size(), run.normal.size());
    for (std::size_t k = 0; k < states.size(); ++k) {
      const Snapshot& s = states[k];
      EXPECT_EQ(s.kind, SnapshotKind::soft_particle);
      EXPECT_EQ(s.frame, static_cast<std::int64_t>(k));
      EXPECT_NEAR(s.overlap, run.normal[k].delta, 1e-12);
      EXPECT_EQ(s.particles.front().role, ParticleRole::inner);
      Vec3 force{};
      if (run.kind == PairKind::soft_solid) {
        force = force_on_wall(s, planes_of(s).front());
      } else {
        for (const SnapshotContact& c : s.contacts) {
          if (static_cast<std::size_t>(c.j) >= s.particles.size()) continue;
          const auto a = s.particles[static_cast<std::size_t>(c.i)].body;
          const auto b = s.particles[static_cast<std::size_t>(c.j)].body;
          if (a != b) force -= c.force;
        }
      }
      EXPECT_NEAR(force[0], run.normal[k].force, 1e-9 * std::abs(run.normal[k].force)) << s.label;
    }
  }
}

TEST(Snapshots, OfMacroRunsAndTwinsCarryTheStress) {
  const KindRuns runs(scene_of("macro-comparison"));
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a"))), 0));
  const auto series = series_of(read_snapshots(runs.out("a")));
  EXPECT_EQ(series.size(), 6U);  // two scenes, a law and two twins each; of the first sample alone
  for (const std::string scene : {"oedometric-35", "shear-35"}) {
    for (const MacroCurve& c : load_macro(runs.out("a") + "/macro_" + scene + ".h5")) {
      if (c.sample != 0) continue;
      const auto& states = series.at(scene + "/" + c.engine + "-0");
      ASSERT_EQ(states.size(), 4U);
      for (const Snapshot& s : states) {
        const auto point = static_cast<std::size_t>(s.frame);
        EXPECT_EQ(s.strain, c.strain[point]);
        EXPECT_EQ(s.kind, c.grains > 0 ? SnapshotKind::twin : SnapshotKind::macro);
        EXPECT_NEAR(axial_stress(s), c.stress_axial[point], 1e-9 * std::abs(c.stress_axial[point]) + 1e-12) << s.label;
        std::int64_t inner = 0;
        for (const SnapshotParticle& p : s.particles) inner += p.role == ParticleRole::inner ? 1 : 0;
        EXPECT_EQ(inner, c.grains);
      }
    }
  }
  EXPECT_EQ(read_snapshots(runs.out("a"), SnapshotChoice::last).size(), 6U);
}

TEST(Snapshots, OfParticlesAreTheFrames) {
  const KindRuns runs({"particles", "microsim", tiny_particles("0.2"), 0});
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a", {"--set", "output.snapshots=5"}))), 0));
  const auto states = read_snapshots(runs.out("a"));
  ASSERT_EQ(states.size(), 21U);
  std::int64_t with_contacts = 0;
  for (const Snapshot& s : states) {
    EXPECT_EQ(s.particles.size(), 60U);
    EXPECT_EQ(s.walls.size(), 2U);
    with_contacts += s.has_contacts ? 1 : 0;
    for (const SnapshotContact& c : s.contacts) EXPECT_LT(norm(c.from - c.to), 0.025);
  }
  EXPECT_EQ(with_contacts, 5);
  EXPECT_TRUE(states.back().has_contacts);
  EXPECT_GT(states.back().contacts.size(), 20U);
  const auto last = read_snapshots(runs.out("a") + "/run.h5", SnapshotChoice::last);
  ASSERT_EQ(last.size(), 1U);
  EXPECT_NEAR(last[0].time, 0.2, 1e-9);
}

TEST(Snapshots, OfDisksAreFlat) {
  const KindRuns runs({"disks", "microsim", tiny_disks("15.0"), 0});
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a"))), 0));
  const auto states = read_snapshots(runs.out("a"));
  ASSERT_EQ(states.size(), 6U);
  const Snapshot& s = states.back();
  EXPECT_EQ(s.dimension, 2);
  EXPECT_EQ(s.particles.size(), 36U);
  ASSERT_EQ(s.walls.size(), 2U);
  EXPECT_EQ(s.walls[0].radius, 6.0);
  EXPECT_EQ(s.walls[1].normal, (Vec3{{0.0, 1.0, 0.0}}));
  EXPECT_EQ(s.walls[1].point[1], -4.0);
  EXPECT_GT(s.contacts.size(), 10U);
  for (const SnapshotParticle& p : s.particles) EXPECT_EQ(p.position[2], 0.0);
  for (const SnapshotContact& c : s.contacts) EXPECT_EQ(c.force[2], 0.0);
}

TEST(Snapshots, OfPowdersAndBoxes) {
  const KindRuns powder(scene_of("powder"));
  ASSERT_TRUE(ended_with(wait_for(start_program(powder.arguments("a"))), 0));
  const auto series = series_of(read_snapshots(powder.out("a")));
  ASSERT_EQ(series.size(), 2U);
  for (const auto& [name, states] : series) {
    ASSERT_GT(states.size(), 2U);
    for (std::size_t k = 1; k < states.size(); ++k) EXPECT_GT(states[k].time, states[k - 1].time);
    EXPECT_EQ(states.back().dimension, 2);
    EXPECT_EQ(states.back().force_unit, "F0");
    EXPECT_TRUE(states.back().has_contacts);
    EXPECT_GT(states.back().contacts.size(), 60U);
  }
  const KindRuns box(scene_of("grain-box"));
  ASSERT_TRUE(ended_with(wait_for(start_program(box.arguments("a"))), 0));
  const auto packs = read_snapshots(box.out("a"));
  const auto record = load_grain_boxes(box.out("a") + "/grain_box.h5");
  ASSERT_EQ(packs.size(), 2U);
  for (std::size_t k = 0; k < packs.size(); ++k) {
    EXPECT_EQ(packs[k].series, record[k].spec.name);
    for (const SnapshotParticle& p : packs[k].particles) EXPECT_GT(p.mass, 0.0);
    // Stress of the walls, from the planes at the low and the high end of z.
    const Vec3 lengths = record[k].state.points.back().lengths;
    double push = 0.0;
    for (const SnapshotContact& c : packs[k].contacts)
      if (static_cast<std::size_t>(c.j) >= packs[k].particles.size()) {
        const Vec3& n = packs[k].walls[static_cast<std::size_t>(c.j) - packs[k].particles.size()].normal;
        push += 0.5 * std::abs(n[2]) * c.normal_force;
      }
    EXPECT_NEAR(push / (lengths[0] * lengths[1]), record[k].state.points.back().stress[2],
                1e-6 * record[k].state.points.back().stress[2]);
  }
}

/// Keeping more, or nothing, changes no number of the run; and nothing kept leaves no file.
TEST(Snapshots, ChangeNothing) {
  const KindRuns runs(scene_of("macro-comparison"));
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("a"))), 0));
  ASSERT_TRUE(ended_with(wait_for(start_program(runs.arguments("b", {"--set", "output.snapshots=0"}))), 0));
  EXPECT_TRUE(read_snapshots(runs.out("b")).empty());
  for (const char* scene : {"oedometric-35", "shear-35"}) {
    for (const char* ending : {".h5", ".xdmf", "_contacts.xdmf"}) {
      const std::string file = std::string("/states_macro_") + scene + ending;
      EXPECT_FALSE(std::filesystem::exists(runs.out("b") + file));
      EXPECT_TRUE(std::filesystem::remove(runs.out("a") + file));
    }
  }
  expect_same_runs(runs.out("a"), runs.out("b"),
                   {"grading-curve.svg", "grading-curve.csv"});  // which is of kept states
}

TEST(Snapshots, OfNoRunAreTrouble) {
  const TemporaryDirectory directory;
  EXPECT_TRUE(read_snapshots(directory.path()).empty());
  EXPECT_THROW((void)read_snapshots(directory.file("nothing")), IoError);
  write_text_atomic(directory.file("run.h5"), "no HDF5");
  EXPECT_THROW((void)read_snapshots(directory.path()), IoError);
  write_text_atomic(directory.file("law.toml"), "");
  EXPECT_THROW((void)read_snapshots(directory.file("law.toml")), InputError);
}

}  // namespace
