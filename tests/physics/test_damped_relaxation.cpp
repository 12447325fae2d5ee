// Damped relaxation: closed forms, an honest residual, an honest end, nothing random about it.
#include "common/dynamics/damped_relaxation.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <limits>

#include "common/dynamics/force_pass.h"
#include "microsim/shell_packing.h"
#include "microsim/soft_experiment.h"
#include "tests/support/small_packing.h"

namespace softgrain {
namespace {

using test::expect_same_state;
using test::glass;
using test::hertz_system;
using test::test_sphere;

constexpr double kRadius = 0.01;

void add_floor_and_ceiling(System3& s, double gap) {
  NewBody<3> plane;
  add_plane(s.particles, plane, Vec3{{0.0, 0.0, 1.0}});
  plane.x[2] = gap;
  add_plane(s.particles, plane, Vec3{{0.0, 0.0, -1.0}});
}

/// Force of a grain of glass against a plane of glass.
double hertz_force(double overlap) {
  return std::sqrt(kRadius) * std::pow(overlap, 1.5) / (1.5 * glass().normal_compliance());
}

RelaxationResult relax(System3& s, double tolerance, std::int64_t max_passes = 20000, double floor = 0.0) {
  DampedOptions options;
  options.tolerance = tolerance;
  options.max_passes = max_passes;
  options.force_floor = floor;
  return DampedRelaxation<3>(options).relax(s);
}

TEST(DampedRelaxation, AGrainBetweenPlanesGoesToTheMiddle) {
  for (const double start : {0.0093, 0.0097, 0.0099}) {
    System3 s = hertz_system<3>(0.3, 1.0, false);
    add_grain(s.particles, test_sphere<3>({{0.0, 0.0, start}}, kRadius, 2500.0));
    add_floor_and_ceiling(s, 0.0192);
    const RelaxationResult result = relax(s, 1e-10);
    EXPECT_EQ(result.end, RelaxationEnd::converged);
    EXPECT_NEAR(s.particles.sphere[0].x[2], 0.0096, 1e-11) << start;
    EXPECT_NEAR(-s.particles.force[1][2], hertz_force(0.0004), 1e-8 * hertz_force(0.0004)) << start;
    EXPECT_NEAR(s.particles.force[2][2], hertz_force(0.0004), 1e-8 * hertz_force(0.0004)) << start;
  }
}

/// Grains of a row between two planes: all but the last one are near the middle.
System3 row_with_one_apart() {
  System3 s = hertz_system<3>(0.3, 1.0, false);
  for (int k = 0; k < 10; ++k)
    add_grain(s.particles, test_sphere<3>({{0.1 * k, 0.0, k < 9 ? 0.0096 + 1e-6 : 0.0093}}, kRadius, 2500.0));
  add_floor_and_ceiling(s, 0.0192);
  return s;
}

TEST(DampedRelaxation, NoneLeadsTheOthersByMoreThanAllowed) {
  const auto gone = [](double lead, std::int64_t passes, double& others) {
    System3 s = row_with_one_apart();
    DampedOptions options;
    options.tolerance = 1e-10;
    options.max_passes = passes;
    options.max_lead = lead;
    const RelaxationResult result = DampedRelaxation<3>(options).relax(s);
    EXPECT_EQ(result.end, passes > 10 ? RelaxationEnd::converged : RelaxationEnd::capped);
    others = s.particles.sphere[0].x[2] - (0.0096 + 1e-6);
    return s.particles.sphere[9].x[2] - 0.0093;
  };
  double others = 0.0;
  const double free = gone(std::numeric_limits<double>::infinity(), 10, others);
  // The first pass has no typical move yet. Then the one apart moves at most 1.5 times as far as the root mean square,
  // which is itself of a tenth of the grains: sqrt(0.1) of its last move.
  const double held = gone(1.5, 10, others);
  EXPECT_LT(held, 0.5 * free);
  EXPECT_GT(held, 0.0);
  // A little less than sqrt(10), every move is a little shorter than the last one, until the lead doubles.
  EXPECT_NEAR(gone(3.0, 4000, others), 0.0003, 1e-11);
  EXPECT_NEAR(others, -1e-6, 1e-11);
}

/// Whether at rest is looked at every ten passes, and after the last one that is allowed.
TEST(DampedRelaxation, MakesNoMorePassesThanAllowed) {
  for (const std::int64_t most : {7, 10, 15, 23}) {
    System3 s = row_with_one_apart();
    const RelaxationResult result = relax(s, 1e-10, most);
    EXPECT_EQ(result.end, RelaxationEnd::capped) << most;
    EXPECT_EQ(result.passes, most);
    System3 same = row_with_one_apart();
    for (const std::int64_t more : {most, std::int64_t{4000}}) (void)relax(same, 1e-10, more);
    EXPECT_NEAR(same.particles.sphere[9].x[2], 0.0096, 1e-11) << "what was left can be taken up";
  }
}

TEST(DampedRelaxation, UnderGravityTheFloorCarriesTheWeight) {
  System3 s = hertz_system<3>(0.0, 1.0, false);
  s.gravity[2] = -9.81;
  const NewBody<3> grain = test_sphere<3>({{0.0, 0.0, 0.0101}}, kRadius, 2500.0);
  add_grain(s.particles, grain);
  add_floor_and_ceiling(s, 1.0);
  const double weight = 9.81 * grain.mass;
  EXPECT_EQ(relax(s, 1e-9, 20000, 1e-3 * weight).end, RelaxationEnd::converged);
  EXPECT_NEAR(-s.particles.force[1][2], weight, 1e-8 * weight);
  const double overlap = kRadius - s.particles.sphere[0].x[2];
  EXPECT_NEAR(hertz_force(overlap), weight, 1e-8 * weight);
}

/// A pressed soft particle: friction, many sizes, a curved wall.
SoftExperiment pressed(double delta) {
  SoftParticleSpec spec;
  spec.trials = 1000;
  SoftExperiment e = make_soft_solid(spec, generate_shell_packing(spec, 3, 0), false);
  e.push(delta * spec.shell_radius);
  return e;
}

/// Largest net force (or moment over radius) on a grain over the mean normal force, from the list of contacts alone.
double residual_by_hand(const System3& s) {
  const auto n = static_cast<std::size_t>(s.particles.grains);
  std::vector<Vec3> force(n);
  std::vector<Vec3> moment(n);
  double sum = 0.0;
  const auto records = contact_records(s);
  for (const auto& c : records) {
    const Vec3 f = c.normal * c.normal_force + c.tangential_force;
    const auto i = static_cast<std::size_t>(c.i);
    force[i] += f;
    moment[i] += cross(c.point - s.particles.sphere[i].x, f);
    sum += std::abs(c.normal_force);
    if (c.j >= s.particles.grains) continue;
    const auto j = static_cast<std::size_t>(c.j);
    force[j] -= f;
    moment[j] -= cross(c.point - s.particles.sphere[j].x, f);
  }
  double worst = 0.0;
  for (std::size_t u = 0; u < n; ++u)
    worst = std::max({worst, norm(force[u]), norm(moment[u]) / s.particles.sphere[u].r});
  return worst / (sum / static_cast<double>(records.size()));
}

TEST(DampedRelaxation, TheResidualIsWhatItSays) {
  for (const double tolerance : {1e-2, 1e-5}) {
    SoftExperiment e = pressed(0.2);
    const RelaxationResult result = relax(e.system, tolerance);
    ASSERT_EQ(result.end, RelaxationEnd::converged);
    EXPECT_LE(result.residual, tolerance);
    EXPECT_NEAR(residual_by_hand(e.system), result.residual, 1e-3 * result.residual + 1e-9) << tolerance;
  }
}

TEST(DampedRelaxation, NothingMovesAtTheEnd) {
  SoftExperiment e = pressed(0.2);
  (void)relax(e.system, 1e-3);
  for (const Vec3& v : e.system.particles.velocity) EXPECT_EQ(v, Vec3{});
  for (const Vec3& w : e.system.particles.spin) EXPECT_EQ(w, Vec3{});
}

TEST(DampedRelaxation, ACappedRunSaysSo) {
  SoftExperiment e = pressed(0.2);
  const RelaxationResult result = relax(e.system, 1e-8, 30);
  EXPECT_EQ(result.end, RelaxationEnd::capped);
  EXPECT_EQ(result.passes, 30);
  EXPECT_GT(result.residual, 1e-8);
  EXPECT_NEAR(residual_by_hand(e.system), result.residual, 1e-3 * result.residual);
}

TEST(DampedRelaxation, WithoutContactsThereIsNothingToDo) {
  System3 s = hertz_system<3>(0.3, 1.0, false);
  add_grain(s.particles, test_sphere<3>({{0.0, 0.0, 0.5}}, kRadius, 2500.0));
  add_floor_and_ceiling(s, 1.0);
  const RelaxationResult result = relax(s, 1e-6);
  EXPECT_EQ(result.end, RelaxationEnd::converged);
  EXPECT_EQ(result.passes, 0);
  EXPECT_EQ(s.particles.sphere[0].x[2], 0.5);
}

TEST(DampedRelaxation, ABrokenStateIsCalledDiverged) {
  System3 s = hertz_system<3>(0.0, 1.0, false);
  add_grain(s.particles, test_sphere<3>({{0.0, 0.0, 0.0095}}, kRadius, 2500.0));
  add_floor_and_ceiling(s, 1.0);
  s.gravity[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(relax(s, 1e-6).end, RelaxationEnd::diverged);
}

/// Enough pairs for the threaded loop: a lattice of overlapping grains in a box of two planes.
System3 crowd() {
  System3 s = hertz_system<3>(0.3, 1.0, false);
  for (const Vec3& x : test::shaken_lattice<3>({}, 0.0195, 16, 1))
    add_grain(s.particles, test_sphere<3>(x, kRadius, 2500.0));
  NewBody<3> plane;
  plane.x[2] = -0.155;
  add_plane(s.particles, plane, Vec3{{0.0, 0.0, 1.0}});
  return s;
}

TEST(DampedRelaxation, ThreadsDoNotMatter) {
  const int threads = omp_get_max_threads();
  System3 one = crowd();
  System3 three = crowd();
  omp_set_num_threads(1);
  const RelaxationResult a = relax(one, 1e-6, 60);
  omp_set_num_threads(3);
  const RelaxationResult b = relax(three, 1e-6, 60);
  omp_set_num_threads(threads);
  EXPECT_GT(one.contacts.size(), 8000);
  EXPECT_EQ(a.passes, b.passes);
  EXPECT_EQ(a.residual, b.residual);
  expect_same_state(one, three);
}

TEST(DampedRelaxation, ASecondCallFindsNothingToDo) {
  SoftExperiment e = pressed(0.2);
  ASSERT_EQ(relax(e.system, 1e-4).end, RelaxationEnd::converged);
  EXPECT_EQ(relax(e.system, 2e-4).passes, 0);
}

}  // namespace
}  // namespace softgrain
