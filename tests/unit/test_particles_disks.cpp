// Scenes of disks in the plane: the cohesive law as the scene names it, against closed forms, the direct evaluation of
// all pairs and the same pack as a powder; restart and threads.
#include <omp.h>

#include <cmath>
#include <numbers>

#include "common/core/error.h"
#include "common/core/random.h"
#include "common/dynamics/contact_watch.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/verlet.h"
#include "common/io/interrupt.h"
#include "common/io/text_file.h"
#include "microsim/particles/particles_run.h"
#include "microsim/particles/trajectory.h"
#include "tests/support/disks.h"
#include "tests/support/small_packing.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

using Scene2 = ParticlesSceneOf<2>;

constexpr double kStiffness = 1e4;  ///< K_N in units of the publication: a = F0 = m = 1
constexpr double kReach = 1e-3;     ///< D0
constexpr double kFriction = 0.5;
constexpr double kRolling = 1e-4 * kStiffness;
constexpr double kRollingLimit = 1e-2 * kFriction;

std::string number(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

/// A disk of diameter 1 has the mass 1.
std::string head(double zeta = 0.0, bool rolling = true) {
  return "kind = \"particles\"\ndimension = 2\n[material.disk]\ndensity = " + number(4.0 / std::numbers::pi) +
         "\n[[contact]]\npair = [\"disk\", \"disk\"]\nlaw = \"cohesive\"\nnormal_stiffness = " + number(kStiffness) +
         "\ntangential_stiffness = " + number(kStiffness) + "\nmu = " + number(kFriction) + "\nzeta = " + number(zeta) +
         "\nadhesion = 1.0\nrange = " + number(kReach) +
         (rolling ? "\nrolling_stiffness = " + number(kRolling) + "\nrolling_limit = " + number(kRollingLimit) : "") +
         "\n";
}

std::string disk(double x, double y, double vx = 0.0, double vy = 0.0, double spin = 0.0, double r = 0.5) {
  return "[[particle]]\nmaterial = \"disk\"\nradius = " + number(r) + "\nposition = [" + number(x) + ", " + number(y) +
         "]\nvelocity = [" + number(vx) + ", " + number(vy) + "]\nspin = " + number(spin) + "\n";
}

Scene2 read_disks(const std::string& text, const std::string& name = "scene.toml") {
  return read_particles_scene<2>(Scene::parse(text, name));
}

ParticlesResultOf<2> run(const std::string& text) { return run_particles(read_disks(text), {}); }

TEST(ParticlesDisks, APairAttractsAtADistanceAndInContact) {
  for (const double overlap : {-1.2 * kReach, -0.75 * kReach, -0.25 * kReach, 0.2e-4, 1e-4, 5e-4}) {
    Scene2 scene = read_disks(head() + disk(0.0, 0.0) + disk(1.0 - overlap, 0.0) + "[time]\nsteps = 1\n");
    force_pass(scene.system, 0.0);
    const double h = 1.0 - (1.0 - overlap);
    const double closed = h > 0.0 ? kStiffness * h - 1.0 : -h < kReach ? -(1.0 + h / kReach) : 0.0;
    EXPECT_NEAR(scene.system.particles.force[1][0], closed, 1e-12) << overlap;
    EXPECT_EQ(scene.system.particles.force[1][1], 0.0);
    EXPECT_EQ(contact_totals(scene.system).contacts, closed == 0.0 ? 0 : 1);
  }
}

/// Without damping a bound pair parts when it moves with more than its well is deep: F0^2/(2 K_N) + F0 D0/2.
TEST(ParticlesDisks, TheForceOfDetachmentIsTheAdhesion) {
  const double well = 0.5 / kStiffness + 0.5 * kReach;
  const double bound = std::sqrt(4.0 * well);  // of each against the other: 1/2 (1/2) v^2
  for (const double share : {0.97, 1.03}) {
    const double v = 0.5 * share * bound;
    const std::string text = head() + disk(0.0, 0.0, -v) + disk(1.0 - 1.0 / kStiffness, 0.0, v) +
                             "[time]\nend = 1.0\n[output]\nevery = 1e-3\n";
    const ParticlesResultOf<2> out = run(text);
    ASSERT_TRUE(out.usable) << out.reason;
    const auto& p = out.system.particles;
    const double gap = p.sphere[1].x[0] - p.sphere[0].x[0] - 1.0;
    EXPECT_EQ(gap > kReach, share > 1.0) << gap;
    double strongest = 0.0;  // pull, from the kinetic energy that is left: F0 where contact and attraction meet
    for (std::size_t k = 1; k < out.trajectory.time.size(); ++k) {
      const double change = out.trajectory.velocity[6 * k] - out.trajectory.velocity[6 * k - 6];
      strongest = std::max(strongest, change / (out.trajectory.time[k] - out.trajectory.time[k - 1]));
    }
    EXPECT_LT(strongest, 1.0 + 1e-6);
    EXPECT_GT(strongest, 0.9);
    EXPECT_TRUE(out.guards.energy_unwatched.empty()) << out.guards.energy_unwatched;
    EXPECT_LT(out.guards.energy.worst, 1e-4);
    EXPECT_EQ(out.guards.energy.count, 0);
  }
}

/// At the equilibrium h = F0/K_N the normal force is zero, and friction still holds mu F0.
TEST(ParticlesDisks, TheCoulombConeBeginsAtMinusTheAdhesion) {
  const std::string text = head() + disk(0.0, 0.0, 0.0, -0.05) + disk(1.0 - 1.0 / kStiffness, 0.0, 0.0, 0.05) +
                           "[time]\nend = 4e-3\nstep = 1e-6\n";
  const auto records = contact_records(run(text).system);
  ASSERT_EQ(records.size(), 1U);
  EXPECT_TRUE(records[0].sliding);
  EXPECT_NEAR(records[0].normal_force, 0.0, 0.1);
  EXPECT_NEAR(norm(records[0].tangential_force), kFriction * (records[0].normal_force + 1.0), 1e-9);
}

/// Disks that turn against each other without sliding: the moment grows with the angle up to mu_r K_N h.
TEST(ParticlesDisks, RollingIsLimitedByTheElasticRepulsion) {
  const double spin = 0.5;
  const auto moment_after = [&](double end) {
    const std::string text = head() + disk(0.0, 0.0, 0.0, 0.0, spin) +
                             disk(1.0 - 1.0 / kStiffness, 0.0, 0.0, 0.0, -spin) + "[time]\nend = " + number(end) +
                             "\nstep = 1e-5\n";
    const auto records = contact_records(run(text).system);
    EXPECT_EQ(records.size(), 1U);
    EXPECT_NEAR(norm(records.at(0).tangential_force), 0.0, 1e-9);
    return records.at(0).rolling_moment[0];
  };
  EXPECT_NEAR(moment_after(1e-3), -kRolling * 2.0 * spin * 1e-3, 0.01 * kRolling * 2.0 * spin * 1e-3);
  EXPECT_NEAR(moment_after(0.05), -kRollingLimit * 1.0, 1e-9);
}

/// Disks with overlaps up to a few 1e-3, some of them within reach of each other only, in a periodic cell.
struct CrowdOfDisks {
  std::vector<HandDisk> disks;
  double edge = 0.0;
};

CrowdOfDisks crowd(int side) {
  CrowdOfDisks out{{}, 0.99 * side};
  RandomStream random(11, RandomPurpose::test, 0);
  for (int n = 0; n < side * side; ++n)
    out.disks.push_back({{{0.99 * (n % side) + 0.008 * random.uniform(), 0.99 * (n / side) + 0.008 * random.uniform()}},
                         0.5 - 0.004 * random.uniform()});
  return out;
}

std::string scene_of(const CrowdOfDisks& c, const TemporaryDirectory& directory, const std::string& more,
                     double zeta = 0.8) {
  std::string many = std::to_string(c.disks.size()) + " " + number(c.edge) + " " + number(c.edge) + " 0\n";
  for (const HandDisk& d : c.disks) many += number(d.x[0]) + " " + number(d.x[1]) + " 0 " + number(d.r) + "\n";
  write_text_atomic(directory.file("many.xyzr"), many);
  return head(zeta) + "[particles]\nfile = \"many.xyzr\"\nmaterial = \"disk\"\n[cell]\nsize = \"file\"\n" +
         "periodic = [true, true]\n" + more;
}

TEST(ParticlesDisks, ThePackHasTheForcesOfThePowderAndOfAllPairs) {
  const TemporaryDirectory directory;
  const CrowdOfDisks c = crowd(14);
  Scene2 scene = read_disks(scene_of(c, directory, "[time]\nsteps = 400\n"), directory.file("scene.toml"));
  PowderSpec spec;
  spec.stiffness = kStiffness;
  spec.friction = kFriction;
  spec.range = kReach;
  spec.rolling = true;
  System<2> powder = disks_by_hand(spec, c.disks, c.edge);
  System<2>& s = scene.system;
  force_pass(s, 0.0);
  force_pass(powder, 0.0);
  const auto law = std::get<CohesiveDisk<true, true>>(powder_law(spec));
  std::vector<Vec<2>> direct(c.disks.size());
  int distant = 0;
  for (std::size_t i = 0; i < direct.size(); ++i)
    for (std::size_t j = 0; j < direct.size(); ++j) {
      if (i == j) continue;
      Vec<2> d = c.disks[i].x - c.disks[j].x;
      for (int k = 0; k < 2; ++k) d[k] -= c.edge * std::round(d[k] / c.edge);
      ContactState<2> state;
      state.overlap = c.disks[i].r + c.disks[j].r - norm(d);
      distant += state.overlap < 0.0 && -state.overlap < kReach ? 1 : 0;
      direct[i] += d * (law.evaluate(state).normal_force / norm(d));
    }
  EXPECT_GT(distant, 10);
  for (std::size_t u = 0; u < direct.size(); ++u)
    for (int k = 0; k < 2; ++k) {
      EXPECT_EQ(s.particles.force[u][k], powder.particles.force[u][k]) << u;
      EXPECT_NEAR(s.particles.force[u][k], direct[u][k], 1e-9) << u;
    }
  // And in motion: masses agree to the last bits only.
  const ParticlesResultOf<2> out = run_particles(scene, {});
  ASSERT_TRUE(out.usable) << out.reason;
  VelocityVerlet<2> integrator(scene.time.step);
  integrator.initialise(powder);
  integrator.advance(powder, scene.time.steps);
  for (std::size_t u = 0; u < direct.size(); ++u) {
    EXPECT_NEAR(out.system.particles.spin[u][0], powder.particles.spin[u][0], 1e-7) << u;
    for (int k = 0; k < 2; ++k)
      EXPECT_NEAR(out.system.particles.velocity[u][k], powder.particles.velocity[u][k], 1e-7) << u;
  }
}

/// So many that they are put into spatial order on the way.
TEST(ParticlesDisks, ThreadsAndRestartsKeepTheBits) {
  const TemporaryDirectory directory;
  const std::string text = scene_of(crowd(66), directory, "[time]\nsteps = 300\n[checkpoint]\nevery_steps = 100\n");
  const Scene2 scene = read_disks(text, directory.file("scene.toml"));
  ASSERT_GE(scene.system.particles.grains, 2000);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const ParticlesResultOf<2> whole = run_particles(scene, {});
  omp_set_num_threads(3);
  const ParticlesResultOf<2> parallel = run_particles(scene, {});
  omp_set_num_threads(threads);
  ASSERT_GT(whole.system.contacts.size(), 8000) << "too small for the parallel path";
  expect_same_state(whole.system, parallel.system);
  ParticlesControl control;
  control.checkpoint = directory.file("checkpoint.h5");
  control.progress = [](std::int64_t step) {
    if (step >= 128) request_interrupt();
  };
  EXPECT_THROW((void)run_particles(scene, control), Interrupted);
  clear_interrupt();
  control.resume = true;
  control.progress = nullptr;
  const ParticlesResultOf<2> resumed = run_particles(scene, control);
  expect_same_state(whole.system, resumed.system);
  EXPECT_EQ(whole.trajectory.spin, resumed.trajectory.spin);
  EXPECT_GT(norm(Vec<1>(whole.system.particles.spin[7])), 0.0);
}

/// Gravity, a rising line, a circle: walls of two dimensions, and what is recorded of them.
TEST(ParticlesDisks, WallsAreLinesAndCircles) {
  const std::string wall =
      "[[contact]]\npair = [\"disk\", \"rigid\"]\nlaw = \"linear-spring\"\nrestitution = 0.2\nmu = 0.3\n"
      "normal_stiffness = 1e4\ntangential_stiffness = 1e4\n"
      "[[wall]]\nshape = \"plane\"\npoint = [0.0, -2.0]\nnormal = [0.0, 1.0]\nmaterial = \"rigid\"\n"
      "[[wall]]\nshape = \"sphere-inside\"\ncenter = [0.0, 0.0]\nradius = 4.0\nmaterial = \"rigid\"\n";
  const ParticlesResultOf<2> out = run("gravity = [0.0, -1.0]\n" + head(0.8) + disk(0.0, -1.0) + disk(1.5, 1.0) + wall +
                                       "[time]\nend = 10.0\nstep = 1e-3\n");
  ASSERT_TRUE(out.usable) << out.reason;
  const auto& p = out.system.particles;
  EXPECT_NEAR(p.sphere[0].x[1], -1.5, 1e-3);
  EXPECT_NEAR(p.sphere[1].x[1], -1.5, 2e-2);
  EXPECT_EQ(out.trajectory.position.size(), out.trajectory.time.size() * 2 * 3);
  EXPECT_EQ(out.trajectory.position[2], 0.0);
  EXPECT_EQ(out.trajectory.wall_position.size(), out.trajectory.time.size() * 2 * 3);
}

TEST(ParticlesDisks, TheStepFollowsTheStiffestSpringAndTheAttraction) {
  const std::string pair = disk(0.0, 0.0) + disk(1.1, 0.0) + "[time]\nend = 1.0\n";
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = head() + pair;
    text.replace(text.find(from), from.size(), to);
    return read_disks(text).time;
  };
  const double plain = read_disks(head() + pair).time.natural_time;
  EXPECT_NEAR(plain, 1.0 / std::sqrt(kStiffness), 1e-12);
  EXPECT_NEAR(with("range = " + number(kReach), "range = 1e-6").natural_time, 1e-3, 1e-9) << "slope F0/D0 = 1e6";
  EXPECT_NEAR(with("rolling_stiffness = 1", "rolling_stiffness = 1e5").natural_time, 1.0 / std::sqrt(8e5), 1e-9);
  EXPECT_NEAR(with("tangential_stiffness = 10000", "tangential_stiffness = 90000").natural_time, plain / 3.0, 1e-9);
  const SceneTime moving = read_disks(head() + disk(0.0, 0.0, 1.0) + disk(1.1, 0.0) + "[time]\nend = 1.0\n").time;
  EXPECT_THROW((void)with("end = 1.0", "end = 1.0\nstep = 2.1e-3"), InputError);
  EXPECT_NO_THROW((void)with("end = 1.0", "end = 1.0\nstep = 1.9e-3"));
  EXPECT_NEAR(moving.contact_time, std::numbers::pi * std::sqrt(0.5 / kStiffness), 1e-9);
  EXPECT_NEAR(moving.reach_time, kReach, 1e-12) << "at speed 1";
  EXPECT_LE(moving.step, kReach / 10.0);
  EXPECT_GT(moving.step, 0.99 * kReach / 10.0);
}

TEST(ParticlesDisks, WhatCannotBeCombinedIsRefused) {
  const std::string rest = disk(0.0, 0.0) + disk(1.1, 0.0) + "[time]\nend = 1.0\n";
  const auto refused = [&](std::string text, const std::string& from, const std::string& to,
                           const std::vector<std::string>& words) {
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    try {
      const Scene scene = Scene::parse(text, "scene.toml");
      if (particles_dimension(scene) == 2)
        (void)read_particles_scene<2>(scene);
      else
        (void)read_particles_scene<3>(scene);
      ADD_FAILURE() << to << " was accepted";
    } catch (const InputError& e) {
      for (const std::string& word : words)
        EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << word << " not in: " << e.what();
    }
  };
  const std::string good = head() + rest;
  refused(good, "dimension = 2", "dimension = 3", {"law", "disks", "dimension = 2"});
  refused(good, "dimension = 2", "dimension = 4", {"dimension", "2"});
  refused(good, "\"cohesive\"", "\"hertz-tsuji\"\nrestitution = 0.5", {"law of spheres", "cohesive"});
  refused(good, "\"cohesive\"", "\"law-card\"\nfile = \"x\"", {"law of spheres"});
  refused(good, "position = [0, 0]", "position = [0, 0, 0]", {"position", "two components"});
  refused(good, "mu = 0.5", "mu = 0.0", {"rolling_stiffness", "needs friction"});
  refused(good, "rolling_stiffness = 1\n", "", {"rolling_limit", "rolling_stiffness"});
  refused(good, "adhesion = 1.0", "adhesion = 0.0", {"range", "without adhesion"});
  refused(good, "adhesion = 1.0\n", "", {"adhesion"});
  refused(good, "range = 0.001", "range = 0.0", {"range"});
  refused(good, "range = 0.001", "range = 1e29", {"scene.toml:", "range = 1e+29", "at most 5 m, 10 radii"});
  refused(good, "density = " + number(4.0 / std::numbers::pi), "density = \"2500 kg/m^3\"", {"density", "kg/m^2"});
  refused(head(0.0, false) + rest, "mu = 0.5", "mu = 0.0", {"tangential_stiffness", "friction"});
  refused(
      good, "[time]",
      "[[contact]]\npair = [\"disk\", \"rigid\"]\nlaw = \"cohesive\"\nnormal_stiffness = 1e4\nmu = 0.0\nzeta = 0.8\n"
      "adhesion = 1.0\nrange = 1e-3\n[[wall]]\nshape = \"plane\"\npoint = [0, -1]\nnormal = [0, 1]\n"
      "material = \"rigid\"\n[time]",
      {"wall", "attracts at a distance", "adhesion = 0"});
  refused(good, "[time]", "[cell]\nsize = [5, 5]\nperiodic = [true, true, true]\n[time]", {"periodic", "two flags"});
}

}  // namespace
