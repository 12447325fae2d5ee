// The same bits for any number of threads, where the parallel path is really taken.
#include <omp.h>

#include <numeric>

#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/parallel_pass.h"
#include "common/dynamics/verlet.h"
#include "common/io/hdf5_file.h"
#include "common/neighbours/spatial_order.h"
#include "macrosim/preparation.h"
#include "macrosim/pressed_box.h"
#include "microsim/particles/particles_run.h"
#include "tests/support/small_packing.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

/// Dense frictional lattice between planes; a shell around the first layer's grains adds the third geometry.
System3 large_packing() {
  System3 s = hertz_system<3>(0.4, 0.8, true);
  s.gravity = {{0.0, 0.0, -9.81}};
  RandomStream random(9, RandomPurpose::test, 1);
  const auto places = shaken_lattice<3>({}, 0.2, 16, 6);
  const auto shell = static_cast<Slot>(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    NewBody<3> grain = test_sphere<3>(places[k], 0.1 + 0.01 * random.uniform(), 2500.0, k % 2 == 0 ? shell : -1);
    for (int d = 0; d < 3; ++d) grain.velocity[d] = 2.0 * random.uniform() - 1.0;
    add_grain(s.particles, grain);
  }
  NewBody<3> wall;
  wall.r = 2.72;
  add_shell(s.particles, wall);
  NewBody<3> plane;
  plane.x[2] = -1.58;
  add_plane(s.particles, plane, Vec3{{0.0, 0.0, 1.0}});
  return s;
}

/// The same with grains in no order: threads take ranges of slots, and most pairs have two owners.
System3 shuffled_packing() {
  System3 s = large_packing();
  RandomStream random(9, RandomPurpose::test, 2);
  std::vector<Slot> order(static_cast<std::size_t>(s.particles.grains));
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[random.below(k)]);
  reorder_grains(s, order);
  s.particles.id.clear();
  return s;
}

/// Shells side by side, so many that each belongs to one thread with all that is in it; grains of neighbours touch.
System3 many_shells() {
  System3 s = hertz_system<3>(0.4, 0.8, true);
  RandomStream random(9, RandomPurpose::test, 3);
  constexpr int kAcross = 3;
  constexpr double kApart = 1.35;
  constexpr int kGrains = 6;
  const auto shells = shaken_lattice<3>({}, kApart, kAcross, 8);
  const auto first = static_cast<Slot>(shells.size() * kGrains * kGrains * kGrains);
  for (std::size_t n = 0; n < shells.size(); ++n)
    for (const Vec3& x : shaken_lattice<3>(shells[n], 0.2, kGrains, 10 + n)) {
      NewBody<3> grain = test_sphere<3>(x, 0.1 + 0.01 * random.uniform(), 2500.0, first + static_cast<Slot>(n));
      for (int d = 0; d < 3; ++d) grain.velocity[d] = 2.0 * random.uniform() - 1.0;
      add_grain(s.particles, grain);
    }
  for (const Vec3& x : shells) {
    NewBody<3> shell;
    shell.x = x;
    shell.r = 1.05;
    add_shell(s.particles, shell);
  }
  return s;
}

System3 run_with(int threads, int steps, System3 s = large_packing()) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  VelocityVerlet<3> integrator(1e-4);
  integrator.initialise(s);
  for (int k = 0; k < steps; ++k) integrator.step(s);
  omp_set_num_threads(before);
  return s;
}

TEST(Threads, AnyNumberGivesTheSameBits) {
  const System3 one = run_with(1, 60);
  ASSERT_GT(one.contacts.size(), 8000) << "too small for the parallel path";
  ASSERT_EQ(one.contacts.sections.size(), 3U) << "all three geometries";
  EXPECT_GT(one.neighbours.rebuilds, 1);
  for (const int threads : {2, 3, 8}) {
    SCOPED_TRACE(threads);
    expect_same_state(one, run_with(threads, 60));
  }
}

TEST(Threads, GrainsInNoOrderGiveTheSameBits) {
  const System3 one = run_with(1, 60, shuffled_packing());
  EXPECT_GT(one.neighbours.rebuilds, 1);
  for (const int threads : {2, 5}) expect_same_state(one, run_with(threads, 60, shuffled_packing()));
}

TEST(Threads, WholeShellsGiveTheSameBits) {
  const System3 one = run_with(1, 60, many_shells());
  ASSERT_GT(one.contacts.size(), 8000) << "too small for the parallel path";
  for (const int threads : {2, 3}) expect_same_state(one, run_with(threads, 60, many_shells()));
}

/// What each thread does in a pass: every body has one owner and lies in a long stretch, every pair is looked at by the
/// owners of its bodies, and all look at about as many.
TEST(Threads, PartsCoverEverythingOnceAndAreAlike) {
  for (System3 s : {large_packing(), shuffled_packing(), many_shells()}) {
    reorder_grains(s, spatial_order(s));
    const int before = omp_get_max_threads();
    omp_set_num_threads(4);
    force_pass(s, 0.0);
    const auto* const own = owned_bodies(s);
    const std::vector<PartSize> parts = part_sizes(s);
    omp_set_num_threads(before);
    ASSERT_NE(own, nullptr);
    ASSERT_EQ(parts.size(), 4U);
    std::vector<int> owners(s.particles.sphere.size(), 0);
    std::vector<std::size_t> owner(owners.size());
    std::size_t stretches = 0;
    for (std::size_t t = 0; t < own->size(); ++t)
      for (const BodyRange& range : (*own)[t]) {
        ++stretches;
        for (std::size_t u = range.begin; u < range.end; ++u) ++owners[u], owner[u] = t;
      }
    for (const int many : owners) ASSERT_EQ(many, 1);
    EXPECT_LT(stretches, owners.size() / 16);
    std::vector<PartSize> expected(parts.size());
    for (std::size_t c = 0; c < s.contacts.i.size(); ++c) {
      const std::size_t first = owner[at(s.contacts.i[c])];
      const std::size_t second = owner[at(s.contacts.j[c])];
      ++expected[first].pairs;
      if (first == second) continue;
      ++expected[second].pairs;
      ++expected[second].foreign;
    }
    std::int64_t all = 0;
    for (const PartSize& part : expected) all += part.pairs;
    for (std::size_t t = 0; t < parts.size(); ++t) {
      EXPECT_EQ(parts[t].pairs, expected[t].pairs);
      EXPECT_EQ(parts[t].foreign, expected[t].foreign);
      EXPECT_GT(parts[t].neighbours, 0);
      EXPECT_NEAR(static_cast<double>(4 * parts[t].pairs) / static_cast<double>(all), 1.0, 0.15) << t;
    }
  }
}

/// Bodies of a macro scene on their way into touch: relaxation and box, whose sums go over all bodies.
MacroPacking pressed(int threads, Boundary boundary) {
  MacroSpec spec;
  spec.bodies = 5000;
  spec.boundary = boundary;
  spec.soft_share = 0.0;
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  MacroPacking packing = place_loosely(drawn_bodies(spec, 3, 0), 3, 0, 0.36, boundary);
  HardBodies hard(spec, packing, 0.3);
  reorder_grains(hard.system, spatial_order(hard.system));
  const double pressure = 1e-3 * spec.youngs_modulus;
  PressedBox walls(hard.box, {{true, true, true}, {{pressure, pressure, pressure}}, true});
  DampedOptions options;
  options.max_passes = 250;
  options.least_stiffness = 1e-3 * spec.youngs_modulus;
  const RelaxationResult rest = DampedRelaxation<3>(options).relax(hard.system, walls);
  EXPECT_EQ(rest.end, RelaxationEnd::capped);
  EXPECT_GT(hard.system.contacts.size(), 8000) << "too small for the parallel path";
  restore_order(hard.system);
  hard.take_over(packing);
  omp_set_num_threads(before);
  return packing;
}

TEST(Threads, RelaxationUnderPressureGivesTheSameBits) {
  for (const Boundary boundary : {Boundary::walls, Boundary::periodic}) {
    const MacroPacking one = pressed(1, boundary);
    EXPECT_GT(one.springs.size(), 100U);
    for (const int threads : {2, 3}) {
      const MacroPacking many = pressed(threads, boundary);
      EXPECT_EQ(one.high, many.high) << threads;
      for (std::size_t k = 0; k < one.bodies.size(); ++k)
        ASSERT_EQ(one.bodies[k].x, many.bodies[k].x) << threads << " " << k;
      ASSERT_EQ(one.springs.size(), many.springs.size()) << threads;
      for (std::size_t k = 0; k < one.springs.size(); ++k)
        ASSERT_EQ(one.springs[k].spring, many.springs[k].spring) << k;
    }
  }
}

/// A run of many grains just before the step at which they are put in order for the second time.
ParticlesResult ordered_twice(int threads, const std::string& checkpoint) {
  constexpr std::int64_t kSecondOrder = 8192;
  ParticlesScene scene;
  scene.record = false;
  scene.checkpoint_steps = kSecondOrder;
  scene.time.step = 1e-4;
  scene.time.steps = kSecondOrder + 8;
  for (GuardRule* rule : {&scene.guards.overlap, &scene.guards.energy, &scene.guards.escape, &scene.guards.wall_travel})
    rule->action = GuardAction::ignore;
  System3 start = large_packing();
  start.step = kSecondOrder - 12;
  for (auto& v : start.particles.velocity) v = v * 60.0;  // so that they soon have other neighbours
  ParticlesControl control;
  control.checkpoint = checkpoint;
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  ParticlesResult out = run_particles(scene, start, control);
  omp_set_num_threads(before);
  EXPECT_TRUE(out.usable) << out.reason;
  return out;
}

/// Which grain was in which slot when a run was saved.
std::vector<std::int32_t> saved_order(const std::string& checkpoint) {
  const auto ids = h5::open_file(checkpoint).open("system").open("bodies").integers("id");
  return {ids.begin(), ids.end()};
}

TEST(Threads, GrainsPutInOrderAgainGoOnAsIfTheyHadNotBeen) {
  const TemporaryDirectory directory;
  const System3 one = ordered_twice(1, directory.file("1.h5")).system;
  const System3 start = large_packing();
  const std::vector<Slot> first = spatial_order(start);
  const std::vector<std::int32_t> second = saved_order(directory.file("1.h5"));
  ASSERT_EQ(second.size(), first.size());
  std::size_t others = 0;
  for (std::size_t k = 0; k < first.size(); ++k) others += first[k] != second[k] ? 1 : 0;
  EXPECT_GT(others, 20U) << "the second order is another one";
  for (const int threads : {2, 3, 8}) {
    const std::string name = directory.file(std::to_string(threads) + ".h5");
    expect_same_state(one, ordered_twice(threads, name).system);
    EXPECT_EQ(saved_order(name), second) << threads;
  }
  System3 plain = large_packing();
  for (auto& v : plain.particles.velocity) v = v * 60.0;
  VelocityVerlet<3> integrator(1e-4);
  integrator.initialise(plain);
  integrator.advance(plain, 20);
  ASSERT_TRUE(one.particles.id.empty());
  for (std::size_t u = 0; u < plain.particles.sphere.size(); ++u) {
    EXPECT_LT(norm(one.particles.sphere[u].x - plain.particles.sphere[u].x), 1e-10) << u;
    EXPECT_LT(norm(one.particles.velocity[u] - plain.particles.velocity[u]), 1e-6) << u;
  }
}

}  // namespace
