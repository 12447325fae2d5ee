// Increments by least work on systems of the force loop: closed forms, the Coulomb limit of the current normal force,
// no memory of the way of the iteration, and nothing changed when there is no equilibrium.
#include "common/statics/least_work_step.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/residual.h"
#include "microsim/protocol.h"
#include "microsim/shell_packing.h"
#include "microsim/soft_experiment.h"
#include "tests/support/small_packing.h"

namespace softgrain {
namespace {

using test::expect_same_state;
using test::glass;
using test::hertz_system;
using test::test_sphere;

constexpr double kGrainRadius = 0.01;

LeastWorkStepOptions tight(double tolerance = 1e-10) {
  LeastWorkStepOptions options;
  options.tolerance = tolerance;
  options.max_passes = 5000;
  return options;
}

double hertz_force(double overlap) {
  return std::sqrt(kGrainRadius) * std::pow(overlap, 1.5) / (1.5 * glass().normal_compliance());
}

/// Dt sqrt(R h): tangential stiffness of a grain on a plane of its own material.
double mindlin_stiffness(double overlap) {
  return std::sqrt(kGrainRadius * overlap) / (2.0 * glass().tangential_compliance());
}

void add_planes(System3& s, double gap) {
  NewBody<3> plane;
  add_plane(s.particles, plane, Vec3{{0.0, 0.0, 1.0}});
  plane.x[2] = gap;
  add_plane(s.particles, plane, Vec3{{0.0, 0.0, -1.0}});
}

/// A grain between two planes, overlapping each by 1e-4 m.
System3 squeezed_grain(double friction) {
  System3 s = hertz_system<3>(friction, 1.0, false);
  add_grain(s.particles, test_sphere<3>({{0.0, 0.0, 0.0099}}, kGrainRadius, 2500.0));
  add_planes(s, 0.0198);
  std::vector<Vec3> none;
  EXPECT_EQ(LeastWorkStep(tight()).advance(s, none).end, RelaxationEnd::converged);
  return s;
}

TEST(LeastWorkStep, AGrainBetweenPlanesFollowsTheOneThatMoves) {
  for (const double friction : {0.0, 0.3}) {
    System3 s = squeezed_grain(friction);
    std::vector<Vec3> moves(3);
    moves[2] = Vec3{{0.0, 0.0, -4e-4}};
    EXPECT_EQ(LeastWorkStep(tight()).advance(s, moves).end, RelaxationEnd::converged);
    EXPECT_NEAR(s.particles.sphere[0].x[2], 0.0097, 1e-12);
    EXPECT_NEAR(moves[0][2], -2e-4, 1e-12);
    EXPECT_NEAR(s.particles.force[1][2], -hertz_force(3e-4), 1e-8 * hertz_force(3e-4));
  }
}

/// The lower plane is still, the upper one slides: the grain rolls with half its motion and no contact is loaded.
TEST(LeastWorkStep, AGrainRollsBetweenPlanesThatSlide) {
  System3 s = squeezed_grain(0.3);
  std::vector<Vec3> moves(3);
  moves[2] = Vec3{{1e-5, 0.0, 0.0}};
  EXPECT_EQ(LeastWorkStep(tight()).advance(s, moves).end, RelaxationEnd::converged);
  EXPECT_NEAR(moves[0][0], 0.5e-5, 1e-10);
  EXPECT_NEAR(s.particles.force[2][0], 0.0, 1e-8 * hertz_force(1e-4));
}

/// A massless grain is driven along a plane: spring while it sticks, mu times the current normal force once it slides.
TEST(LeastWorkStep, TheCoulombLimitIsThatOfTheCurrentNormalForce) {
  const double friction = 0.3;
  for (const double slide : {1e-6, 1e-4}) {
    System3 s = hertz_system<3>(friction, 1.0, false);
    NewBody<3> driven = test_sphere<3>({{0.0, 0.0, 0.0099}}, kGrainRadius, 0.0);
    driven.mass = 0.0;
    driven.inertia = 0.0;
    add_grain(s.particles, driven);
    add_plane(s.particles, NewBody<3>{}, Vec3{{0.0, 0.0, 1.0}});
    std::vector<Vec3> moves(2);
    EXPECT_EQ(LeastWorkStep(tight()).advance(s, moves).end, RelaxationEnd::converged);
    moves[0] = Vec3{{slide, 0.0, -1e-4}};
    EXPECT_EQ(LeastWorkStep(tight()).advance(s, moves).end, RelaxationEnd::converged);
    const double expected = std::min(mindlin_stiffness(2e-4) * slide, friction * hertz_force(2e-4));
    EXPECT_NEAR(-s.particles.force[0][0], expected, 1e-9 * hertz_force(2e-4)) << slide;
  }
}

/// A soft particle that is already under load.
SoftExperiment loaded_particle(double delta = 0.25) {
  SoftParticleSpec spec;
  spec.trials = 1000;
  SoftExperiment e = make_soft_solid(spec, generate_shell_packing(spec, 3, 0), false);
  make_damped_protocol({})->approach(e, delta * spec.shell_radius);
  DampedOptions options;
  options.tolerance = 1e-6;
  DampedRelaxation<3>(options).relax(e.system);
  return e;
}

RelaxationResult press(SoftExperiment& e, std::vector<Vec3> guess, const LeastWorkStepOptions& options) {
  return LeastWorkStep(options).advance(e.system, guess);
}

TEST(LeastWorkStep, TheResidualIsWhatItSays) {
  SoftExperiment e = loaded_particle();
  LeastWorkStepOptions options = tight(1e-2);
  const RelaxationResult result = press(e, e.second_moves(1e-4 * e.spec.shell_radius), options);
  ASSERT_EQ(result.end, RelaxationEnd::converged);
  EXPECT_LT(result.passes, 400);
  EXPECT_LT(residual(e.system).relative(0.0), 1.1e-2);
}

TEST(LeastWorkStep, TheStateDoesNotDependOnTheFirstGuess) {
  const SoftExperiment start = loaded_particle();
  const double move = 1e-4 * start.spec.shell_radius;
  SoftExperiment a = start;
  SoftExperiment b = start;
  std::vector<Vec3> guess = start.second_moves(move);
  const LeastWorkStepOptions options = tight(1e-5);
  ASSERT_EQ(press(a, guess, options).end, RelaxationEnd::converged);
  for (Slot i = 0; i < start.first_grains; ++i) guess[static_cast<std::size_t>(i)][0] = -0.3 * move;
  ASSERT_EQ(press(b, guess, options).end, RelaxationEnd::converged);
  const double force = a.force_on_second()[0];
  EXPECT_GT(force, 0.1);
  EXPECT_NEAR(b.force_on_second()[0], force, 1e-4 * force);
}

TEST(LeastWorkStep, WithoutEquilibriumNothingIsChanged) {
  SoftExperiment e = loaded_particle();
  const SoftExperiment before = e;
  LeastWorkStepOptions options = tight(1e-9);
  options.max_passes = 7;
  std::vector<Vec3> moves = e.second_moves(0.01 * e.spec.shell_radius);
  const std::vector<Vec3> given = moves;
  const RelaxationResult result = LeastWorkStep(options).advance(e.system, moves);
  EXPECT_EQ(result.end, RelaxationEnd::capped);
  EXPECT_GE(result.passes, 7);
  EXPECT_EQ(moves, given);
  for (std::size_t u = 0; u < before.system.particles.sphere.size(); ++u)
    EXPECT_EQ(e.system.particles.sphere[u].x, before.system.particles.sphere[u].x);
  EXPECT_EQ(e.force_on_second(), before.force_on_second());
}

/// A guess that throws a grain out of its shell is a failed increment, not the end of the run.
TEST(LeastWorkStep, AThrownGrainIsAFailedIncrement) {
  SoftExperiment e = loaded_particle();
  std::vector<Vec3> moves = e.second_moves(0.0);
  moves[0] = Vec3{{5.0 * e.spec.shell_radius, 0.0, 0.0}};
  const Vec3 force = e.force_on_second();
  EXPECT_EQ(LeastWorkStep(tight()).advance(e.system, moves).end, RelaxationEnd::diverged);
  EXPECT_EQ(e.force_on_second(), force);
}

}  // namespace
}  // namespace softgrain
