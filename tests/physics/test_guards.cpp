// Guards of explicit particles: what must not happen stops the run or is counted, as the scene says.
#include "microsim/particles/guards.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/core/error.h"
#include "common/dynamics/verlet.h"
#include "common/io/hdf5_file.h"
#include "microsim/particles/particles_run.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

std::string head(double restitution) {
  return "kind = \"particles\"\n[material.glass]\ndensity = 2500.0\nE = \"1 MPa\"\nnu = 0.2\n"
         "[[contact]]\npair = [\"glass\", \"glass\"]\nlaw = \"hertz-tsuji\"\nmu = 0.3\nrestitution = " +
         std::to_string(restitution) + "\ntangential = \"rescaled\"\n";
}

std::string particle(const std::string& position, const std::string& velocity, double r = 0.01) {
  return "[[particle]]\nmaterial = \"glass\"\nradius = " + std::to_string(r) + "\nposition = [" + position +
         "]\nvelocity = [" + velocity + "]\n";
}

ParticlesResult run(const std::string& text) {
  const ParticlesScene scene = read_particles_scene(Scene::parse(text, "scene.toml"));
  return run_particles(scene, {});
}

/// Two spheres that meet at 2 V; 3 m/s goes through 40 % of a radius, 30 m/s through all of it.
std::string impact(const std::string& speed, const std::string& time, const std::string& guards = "") {
  return head(1.0) + particle("-0.0101, 0.0, 0.0", speed + ", 0.0, 0.0") +
         particle("0.0101, 0.001, 0.0", "-" + speed + ", 0.0, 0.0") + "[time]\n" + time + "\n" + guards;
}

TEST(Guards, ASoundRunIsLeftAlone) {
  const ParticlesResult r = run(impact("3.0", "end = 5e-3\nstep = 2e-6"));
  ASSERT_TRUE(r.usable) << r.reason;
  EXPECT_EQ(r.guards.energy_unwatched, "");
  EXPECT_GT(r.guards.overlap.worst, 0.05);
  EXPECT_LT(r.guards.energy.worst, 1e-4);
  EXPECT_EQ(r.guards.overlap.count + r.guards.energy.count + r.guards.escape.count + r.guards.wall_travel.count, 0);
  EXPECT_EQ(r.guards.looks, 1 + 2500 / 64 + 1) << "at the start, every 64th step, at the end";
}

TEST(Guards, DeepOverlapsAreCountedOrStopTheRun) {
  const std::string limit = "[guards.overlap]\nlimit = 0.05\naction = ";
  const ParticlesResult counted = run(impact("3.0", "end = 5e-3\nstep = 2e-6", limit + "\"count\"\n"));
  EXPECT_TRUE(counted.usable) << counted.reason;
  EXPECT_GT(counted.guards.overlap.count, 0);
  const ParticlesResult stopped = run(impact("3.0", "end = 5e-3\nstep = 2e-6", limit + "\"stop\"\n"));
  EXPECT_FALSE(stopped.usable);
  EXPECT_NE(stopped.reason.find("particle 0 and particle 1 overlap by 0."), std::string::npos) << stopped.reason;
  EXPECT_NE(stopped.reason.find("guards.overlap.limit 0.05"), std::string::npos) << stopped.reason;
  EXPECT_LT(stopped.system.step, counted.system.step) << "ends there";
  const ParticlesResult ignored =
      run(impact("3.0", "end = 5e-3\nstep = 2e-6", "[guards.overlap]\naction = \"ignore\"\n"));
  EXPECT_TRUE(ignored.usable);
  EXPECT_EQ(ignored.guards.overlap.count, 0);
}

/// Twelve contacts each, 40 % of a radius deep: far stiffer than the one contact that the limit of the step is taken
/// from.
std::string compressed_lattice(const std::string& step, const std::string& velocity = "0.01, 0.02, 0.03") {
  constexpr int kCells = 3;
  constexpr double r = 0.01;
  const double edge = 1.6 * r * std::sqrt(2.0);
  const std::string size = std::to_string(kCells * edge);
  std::string text = head(1.0) + "[cell]\nsize = [" + size + ", " + size + ", " + size + "]\n" +
                     "periodic = [true, true, true]\n[time]\nsteps = 2000\nstep = " + step + "\n";
  const double base[4][3] = {{0.0, 0.0, 0.0}, {0.5, 0.5, 0.0}, {0.5, 0.0, 0.5}, {0.0, 0.5, 0.5}};
  for (int n = 0; n < kCells * kCells * kCells; ++n)
    for (const auto& b : base) {
      std::string position;
      const int cell[3] = {n % kCells, n / kCells % kCells, n / kCells / kCells};
      for (int k = 0; k < 3; ++k) position += (k > 0 ? ", " : "") + std::to_string((cell[k] + b[k]) * edge);
      text += particle(position, n == 0 ? velocity : "0.0, 0.0, 0.0", r);
    }
  return text;
}

/// A step that its scene would refuse: what reading cannot see, contacts that form on the way, comes to the same.
ParticlesResult run_with_step(const std::string& text, double step) {
  ParticlesScene scene = read_particles_scene(Scene::parse(text, "scene.toml"));
  scene.time.step = step;
  return run_particles(scene, {});
}

TEST(Guards, EnergyThatGrowsOfItselfStopsTheRun) {
  const std::string text = compressed_lattice("3e-4");
  const ParticlesResult sound = run(text);
  EXPECT_TRUE(sound.usable) << sound.reason;
  EXPECT_LT(sound.guards.energy.worst, 1e-3);
  const ParticlesResult r = run_with_step(text, 9e-4);
  EXPECT_FALSE(r.usable);
  EXPECT_NE(r.reason.find("energy grows although nothing drives the scene"), std::string::npos) << r.reason;
  const ParticlesResult counted = run_with_step(text + "[guards.energy]\naction = \"count\"\n", 9e-4);
  EXPECT_GT(counted.guards.energy.worst, 0.05);
  EXPECT_GT(counted.guards.energy.count, 0);
}

/// Finite positions beyond all proportion, within fewer steps than from one look to the next.
TEST(Guards, WhatFliesApartBetweenTwoLooksIsLost) {
  const std::string periodic = compressed_lattice("3e-4", "0.0, 0.0, 0.0");  // its places are rounded: it moves
  std::string open = periodic;
  open.replace(open.find("true, true, true"), 16, "false, false, false");
  std::string strained = periodic;
  strained.insert(strained.find("periodic ="), "shear_rate = 0.3\n");
  const std::string ignored = "[guards.overlap]\naction = \"ignore\"\n[guards.energy]\naction = \"ignore\"\n";
  for (const std::string& text : {periodic, open, strained})
    for (const double step : {1e2, 1e5, 1e8, 1e20, 1e60}) {
      const ParticlesResult r = run_with_step(text + ignored, step);
      EXPECT_FALSE(r.usable) << step;
      EXPECT_NE(r.reason.find(" is lost: "), std::string::npos) << step << ": " << r.reason;
      EXPECT_LE(r.system.step, 64) << r.reason;
    }
}

TEST(Guards, StepsThatManyContactsMakeUnstableAreRefusedOrNotTaken) {
  const auto refusal = [](const std::string& step) -> std::string {
    try {
      (void)read_particles_scene(Scene::parse(compressed_lattice(step), "scene.toml"));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("3e-4"), "");
  for (const char* step : {"4e-4", "6e-4", "9e-4", "1.4e-3"}) {
    const std::string message = refusal(step);
    EXPECT_NE(message.find("above the stable limit"), std::string::npos) << step << message;
    EXPECT_NE(message.find("has 12 contacts, which together are stiffer than one"), std::string::npos) << message;
  }
  // Of a lattice at rest, where no impact asks for less: the largest fraction of one contact's time, and the usual one.
  const auto at_rest = [](const std::string& step) {
    return read_particles_scene(Scene::parse(compressed_lattice(step, "0.0, 0.0, 0.0"), "scene.toml"));
  };
  ParticlesScene most = at_rest("\"auto\"\nstep_fraction = 0.6");
  EXPECT_LT(most.time.step, 0.2 * most.time.natural_time);
  EXPECT_GT(most.time.step, 0.1 * most.time.natural_time);
  most.system.particles.velocity[0] = Vec3{{0.01, 0.02, 0.03}};
  const ParticlesResult r = run_particles(most, {});
  EXPECT_TRUE(r.usable) << r.reason;
  EXPECT_LT(r.guards.energy.worst, 1e-2);
  const ParticlesScene usual = at_rest("\"auto\"");
  EXPECT_EQ(usual.time.step, 0.05 * usual.time.natural_time);
}

TEST(Guards, DrivenScenesSayThatTheirEnergyIsNotWatched) {
  const ParticlesResult r =
      run(impact("1.0", "end = 1e-3\nstep = 2e-6",
                 "[[wall]]\nshape = \"plane\"\npoint = [0.0, 0.0, -0.1]\nnormal = [0.0, 0.0, 1.0]\nmaterial = "
                 "\"glass\"\nmotion = \"velocity\"\nvelocity = [0.0, 0.0, 0.1]\n"));
  EXPECT_TRUE(r.usable) << r.reason;
  EXPECT_EQ(r.guards.energy_unwatched, "a body is moved at a given velocity");
}

TEST(Guards, GrainsThatLeaveTheirRoomAreFound) {
  const std::string room = "[guards.escape]\nlow = [-0.1, -0.1, -0.1]\nhigh = [0.1, 0.1, 0.1]\n";
  const std::string flight =
      head(1.0) + particle("0.0, 0.0, 0.0", "1.0, 0.0, 0.0") + "[time]\nend = 0.2\nstep = 1e-4\n";
  EXPECT_TRUE(run(flight).usable) << "no room, no guard";
  const ParticlesResult r = run(flight + room);
  EXPECT_FALSE(r.usable);
  EXPECT_NE(r.reason.find("particle 0 has escaped: it is outside guards.escape"), std::string::npos) << r.reason;
  const ParticlesResult counted = run(flight + room + "action = \"count\"\n");
  EXPECT_TRUE(counted.usable);
  EXPECT_NEAR(counted.guards.escape.first_time, 0.1, 64e-4);
}

TEST(Guards, GrainsBehindAWallHaveEscaped) {
  const std::string wall =
      "[[wall]]\nshape = \"plane\"\npoint = [0.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\nmaterial = \"glass\"\n";
  const ParticlesResult r =
      run(head(1.0) + particle("0.0, 0.0, 0.02", "0.0, 0.0, -40.0") + wall + "[time]\nend = 1e-2\nstep = 1e-6\n");
  EXPECT_FALSE(r.usable);
  EXPECT_NE(r.reason.find("particle 0 has escaped: its centre is behind a wall"), std::string::npos) << r.reason;
}

/// Behind two walls and outside the room: one grain.
TEST(Guards, AGrainThatLeftInSeveralWaysIsOne) {
  std::string walls;
  for (const char* normal : {"[0.0, 0.0, 1.0]", "[0.0, 1.0, 0.0]"})
    walls += std::string("[[wall]]\nshape = \"plane\"\npoint = [0.0, 0.0, 0.0]\nnormal = ") + normal +
             "\nmaterial = \"glass\"\n";
  const ParticlesScene scene = read_particles_scene(Scene::parse(
      head(1.0) + particle("0.0, -0.001, -0.001", "0.0, 0.0, 0.0") + particle("0.0, 0.05, 0.05", "0.0, 0.0, 0.0") +
          walls + "[time]\nend = 1e-6\nstep = 1e-6\n[guards.escape]\nlow = [-1.0, 0.0, 0.0]\naction = \"count\"\n",
      "scene.toml"));
  for (const std::string& remark : scene.remarks) EXPECT_EQ(remark.find("more)"), std::string::npos) << remark;
  EXPECT_EQ(run_particles(scene, {}).guards.escape.worst, 1.0);
}

TEST(Guards, AWallThatItsLoadMovesMustNotRunAway) {
  const std::string lid =
      "[[wall]]\nshape = \"plane\"\npoint = [0.0, 0.0, 0.05]\nnormal = [0.0, 0.0, -1.0]\nmaterial = \"glass\"\n"
      "motion = \"force\"\nmass = 0.1\nforce = -1.0\n";  // away from the grains
  const std::string scene =
      head(1.0) + particle("0.0, 0.0, 0.0", "0.0, 0.0, 0.0") + lid + "[time]\nend = 1.0\nstep = 1e-4\n";
  const ParticlesResult r = run(scene);
  EXPECT_FALSE(r.usable);
  EXPECT_NE(r.reason.find("runs away"), std::string::npos) << r.reason;
  EXPECT_NEAR(r.guards.wall_travel_limit, 0.12, 1e-9) << "twice the way through the grain";
  const ParticlesResult wide = run(scene + "[guards.wall]\ntravel = \"1 km\"\n");
  EXPECT_TRUE(wide.usable) << wide.reason;
}

TEST(Guards, ChangeNoBit) {
  std::string off = "[guards.overlap]\naction = \"ignore\"\n[guards.energy]\naction = \"ignore\"\n";
  off += "[guards.escape]\naction = \"ignore\"\n[guards.wall]\naction = \"ignore\"\n";
  const ParticlesResult a = run(impact("3.0", "end = 5e-3\nstep = 2e-6"));
  const ParticlesResult b = run(impact("3.0", "end = 5e-3\nstep = 2e-6", off));
  for (std::size_t u = 0; u < 2; ++u) {
    EXPECT_EQ(a.system.particles.sphere[u].x, b.system.particles.sphere[u].x);
    EXPECT_EQ(a.system.particles.spin[u][2], b.system.particles.spin[u][2]);
  }
  EXPECT_GT(a.guards.looks, 0);
  EXPECT_EQ(b.guards.looks, 0) << "nobody looks when nobody asks";
}

TEST(Guards, WhatWasSeenSurvivesAFile) {
  const TemporaryDirectory directory;
  const ParticlesScene scene = read_particles_scene(
      Scene::parse(impact("3.0", "end = 5e-3\nstep = 2e-6", "[guards.overlap]\nlimit = 1e-9\n"), "scene.toml"));
  System3 s = run_particles(scene, {}).system;
  s.particles.sphere[1].x = s.particles.sphere[0].x + Vec3{{0.018, 0.0, 0.0}};
  s.neighbours.reference.clear();
  VelocityVerlet<3>(1e-6).initialise(s);
  Guards guards(scene.guards, s);
  guards.look(s);
  const std::string path = directory.file("guards.h5");
  {
    h5::AtomicFile file(path);
    guards.save(file.root());
    file.commit();
  }
  Guards other(scene.guards, s);
  other.load(h5::open_file(path));
  EXPECT_EQ(other.report().looks, 1);
  EXPECT_EQ(other.report().overlap.count, 1);
  EXPECT_EQ(other.report().overlap.worst, guards.report().overlap.worst);
  EXPECT_EQ(other.report().overlap.first_time, guards.report().overlap.first_time);
}

TEST(Guards, BadTablesAreRefused) {
  const auto message = [](const std::string& guards) -> std::string {
    try {
      (void)read_particles_scene(Scene::parse(impact("1.0", "end = 1e-3\nstep = 2e-6", guards), "scene.toml"));
    } catch (const InputError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_NE(message("[guards.overlap]\naction = \"stopp\"\n").find("nearest is \"stop\""), std::string::npos)
      << message("[guards.overlap]\naction = \"stopp\"\n");
  EXPECT_NE(message("[guards.energie]\nlimit = 0.1\n").find("energy"), std::string::npos);
  EXPECT_NE(message("[guards.escape]\nlow = [0.0, 0.0, 0.0]\nhigh = [1.0, 0.0, 1.0]\n").find("must be above low"),
            std::string::npos);
}

}  // namespace
