// The measuring arrangement: rigid rotation, forces between the bodies, Newton's third law, closed forms and
// symmetries.
#include "microsim/soft_experiment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/dynamics/damped_relaxation.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/verlet.h"
#include "microsim/measure.h"
#include "microsim/shell_packing.h"

namespace softgrain {
namespace {

SoftParticleSpec small_spec() {
  SoftParticleSpec spec;
  spec.trials = 1000;
  return spec;
}

ShellPacking small_packing(std::uint64_t index) { return generate_shell_packing(small_spec(), 3, index); }

/// Grains given as position and radius in units of the shell.
ShellPacking by_hand(const std::vector<Vec3>& positions, const std::vector<double>& radii) {
  ShellPacking packing;
  packing.position = positions;
  packing.radius = radii;
  return packing;
}

void rest(SoftExperiment& e, double tolerance, std::int64_t max_passes = 40000) {
  DampedOptions options;
  options.tolerance = tolerance;
  options.force_floor = force_floor(e.spec);
  options.max_passes = max_passes;
  DampedRelaxation<3>(options).relax(e.system);
}

/// Second body pushed in by `delta` in increments, each relaxed, the last one well.
void press(SoftExperiment& e, double delta) {
  const int steps = static_cast<int>(std::ceil(delta / 0.01));
  for (int k = 0; k < steps; ++k) {
    e.push(delta * e.spec.shell_radius / steps);
    rest(e, 0.1);
  }
  rest(e, 1e-6);
}

/// D of the Hertz law of two bodies of the spec's material.
double hertz_d(const SoftParticleSpec& s) { return 1.5 * (1.0 - s.poisson_ratio * s.poisson_ratio) / s.youngs_modulus; }

/// A slow turn, as measurements make it.
void turn(SoftExperiment& e, double degrees, bool shell_turns = true) {
  constexpr double kStretch = 0.05;  // degree
  const auto protocol = make_damped_protocol({});
  const double rate = std::copysign(usual_turn_speed(e.spec) / e.spec.shell_radius, degrees);
  const int n = std::max(1, static_cast<int>(std::lround(std::abs(degrees) / kStretch)));
  stop_motion(e.system.particles);
  for (int k = 0; k < n; ++k)
    protocol->run(e, e.turning(rate, shell_turns), degrees * std::numbers::pi / 180.0 / rate / n);
}

Vec3 about_z(const Vec3& x, double degrees) { return rotate(x, {{0.0, 0.0, 1.0}}, degrees * std::numbers::pi / 180.0); }

Slot shell_of_first(const SoftExperiment& e) { return e.system.particles.grains; }

/// A body under inner stress (grains 2 % too large) at rest, with the second body out of reach.
SoftExperiment stressed_alone() {
  ShellPacking packing = small_packing(0);
  for (double& r : packing.radius) r *= 1.02;
  SoftExperiment e = make_soft_solid(small_spec(), packing, false);
  e.push(-0.2 * e.spec.shell_radius);
  rest(e, 1e-5);
  return e;
}

/// A lonely body turns as a rigid one: its forces are carried along.
TEST(SoftExperiment, ATurnOfALonelyBodyCarriesItsForcesAlong) {
  constexpr double kDegrees = 2.0;
  SoftExperiment e = stressed_alone();
  const auto before = contact_records(e.system);
  ASSERT_GT(before.size(), 100U);
  turn(e, kDegrees);
  const auto after = contact_records(e.system);
  double largest = 0.0;
  for (const auto& c : before) largest = std::max(largest, c.normal_force);
  std::size_t found = 0;
  for (const auto& b : before)
    for (const auto& a : after) {
      if (a.i != b.i || a.j != b.j) continue;
      ++found;
      EXPECT_NEAR(a.normal_force, b.normal_force, 0.01 * largest) << a.i << " " << a.j;
      EXPECT_LT(norm(a.tangential_force - about_z(b.tangential_force, kDegrees)), 0.01 * largest) << a.i << " " << a.j;
      EXPECT_LT(norm(a.normal - about_z(b.normal, kDegrees)), 1e-2) << a.i << " " << a.j;
    }
  EXPECT_GT(found, before.size() * 9 / 10);
}

TEST(SoftExperiment, ATurnGoesBackToWhereItCameFrom) {
  SoftExperiment e = stressed_alone();
  const SoftExperiment before = e;
  turn(e, 1.0);
  const auto& sphere = before.system.particles.sphere;
  double farthest = 0.0;
  for (std::size_t u = 0; u < static_cast<std::size_t>(e.first_grains); ++u)
    farthest = std::max(farthest, norm(e.system.particles.sphere[u].x - about_z(sphere[u].x, 1.0)));
  EXPECT_LT(farthest, 1e-3 * e.spec.shell_radius);
  turn(e, -1.0);
  for (std::size_t u = 0; u < static_cast<std::size_t>(e.first_grains); ++u)
    EXPECT_LT(norm(e.system.particles.sphere[u].x - sphere[u].x), 1e-3 * e.spec.shell_radius);
}

/// With a standing shell the springs to the shell load up: their torque about z opposes the turn.
TEST(SoftExperiment, AStandingShellHoldsItsGrainsBack) {
  SoftExperiment turns = stressed_alone();
  SoftExperiment stands = turns;
  turn(turns, 0.1, true);
  turn(stands, 0.1, false);
  const auto on_shell = [](const SoftExperiment& e) {
    double moment = 0.0;
    for (const auto& c : contact_records(e.system))
      if (c.j == shell_of_first(e)) moment += cross(c.point, c.tangential_force)[2];
    return moment;
  };
  const double drag = on_shell(stands) - on_shell(turns);  // on the grains
  EXPECT_LT(drag, 0.0);
  EXPECT_GT(std::abs(drag), 10.0 * std::abs(on_shell(turns)));
}

TEST(SoftExperiment, ForceOnSecondIsTheForceOnThePlane) {
  SoftExperiment e = make_soft_solid(small_spec(), small_packing(0), false);
  press(e, 0.15);
  turn(e, 0.3);
  rest(e, 1e-4);
  force_pass(e.system, 0.0);
  const Vec3 on_plane = e.system.particles.force[static_cast<std::size_t>(e.system.particles.first_plane())];
  EXPECT_GT(on_plane[0], 1e-3);
  EXPECT_LT(norm(on_plane - e.force_on_second()), 1e-12 * norm(on_plane));
}

/// Sum of forces over [begin, end) and one shell.
Vec3 net_force(const SoftExperiment& e, Slot begin, Slot end, Slot shell) {
  Vec3 sum = e.system.particles.force[static_cast<std::size_t>(shell)];
  for (Slot i = begin; i < end; ++i) sum += e.system.particles.force[static_cast<std::size_t>(i)];
  return sum;
}

TEST(SoftExperiment, ActionIsReactionBetweenTwoSoftParticles) {
  SoftExperiment e = make_soft_soft(small_spec(), small_packing(0), small_packing(1), false);
  press(e, 0.40);
  turn(e, 0.3);
  force_pass(e.system, 0.0);
  const Slot n = e.system.particles.grains;
  const Vec3 on_second = net_force(e, e.first_grains, n, n + 1);
  const Vec3 on_first = net_force(e, 0, e.first_grains, n);
  EXPECT_GT(on_second[0], 1e-3);
  EXPECT_LT(norm(on_first + on_second), 1e-11 * norm(on_second));
  EXPECT_LT(norm(on_second - e.force_on_second()), 1e-11 * norm(on_second));
}

TEST(SoftExperiment, PushMovesTheSecondBodyAlone) {
  SoftExperiment e = make_soft_soft(small_spec(), small_packing(0), small_packing(1), false);
  const auto before = e.system.particles;
  e.push(0.01 * e.spec.shell_radius);
  EXPECT_DOUBLE_EQ(e.normal_overlap, 0.01 * e.spec.shell_radius);
  const auto& p = e.system.particles;
  for (Slot i = 0; i < p.size(); ++i) {
    const auto u = static_cast<std::size_t>(i);
    const bool first = i < e.first_grains || i == shell_of_first(e);
    const Vec3 move = p.sphere[u].x - before.sphere[u].x;
    EXPECT_EQ(move[1], 0.0);
    EXPECT_EQ(move[2], 0.0);
    if (first)
      EXPECT_EQ(move[0], 0.0) << i;
    else
      EXPECT_NEAR(move[0], -0.01 * e.spec.shell_radius, 1e-15) << i;
    EXPECT_EQ(p.velocity[u], Vec3{}) << i;
  }
}

TEST(SoftExperiment, BodiesTouchButDoNotActAtTheStart) {
  const SoftExperiment plane = make_soft_solid(small_spec(), small_packing(0), false);
  EXPECT_EQ(plane.force_on_second(), Vec3{});
  const SoftExperiment other = make_soft_soft(small_spec(), small_packing(0), small_packing(1), false);
  EXPECT_EQ(other.force_on_second(), Vec3{});
}

TEST(SoftExperiment, PositiveAnglesDragTheSecondBodyTowardsPlusY) {
  for (const std::uint64_t index : {0U, 1U}) {
    SoftExperiment e = make_soft_solid(small_spec(), small_packing(index), false);
    press(e, 0.25);
    const double prestrain = e.force_on_second()[1];
    for (const double angle : {0.05, 0.5, -0.05, -0.5}) {
      SoftExperiment turned = e;
      turn(turned, angle);
      rest(turned, 1e-4);
      EXPECT_GT((turned.force_on_second()[1] - prestrain) * angle, 0.0)
          << "packing " << index << ", " << angle << " degrees";
    }
  }
}

TEST(SoftExperiment, ASingleCentralGrainGivesTheHertzForce) {
  const SoftParticleSpec spec = small_spec();
  const double radius = 0.9 * spec.shell_radius;
  for (const double depth : {0.05, 0.2, 0.5}) {
    SoftExperiment e = make_soft_solid(spec, by_hand({{}}, {0.9}), false);
    e.push((0.1 + depth) * spec.shell_radius);
    const double expected = std::sqrt(radius) * std::pow(depth * spec.shell_radius, 1.5) / hertz_d(spec);
    EXPECT_NEAR(e.force_on_second()[0], expected, 1e-12 * expected) << depth;
  }
}

/// Squeezed between the plane and the far side of the shell: R12 = R at the plane, R Rs/(Rs - R) at the shell, so the
/// overlaps divide as 1 : ((Rs - R)/Rs)^(1/3).
TEST(SoftExperiment, AGrainBetweenPlaneAndShellSharesTheOverlap) {
  const SoftParticleSpec spec = small_spec();
  const double rs = spec.shell_radius;
  for (const double share : {0.5, 0.8, 0.95}) {
    SoftExperiment e = make_soft_solid(spec, by_hand({{}}, {share}), false);
    const double squeeze = 0.05 * rs;
    e.push(2.0 * (1.0 - share) * rs + squeeze);
    rest(e, 1e-9);
    const double overlap = squeeze / (1.0 + std::cbrt(1.0 - share));
    const double expected = std::sqrt(share * rs) * std::pow(overlap, 1.5) / hertz_d(spec);
    EXPECT_NEAR(e.force_on_second()[0], expected, 1e-6 * expected) << share;
  }
}

/// Mirror image under z -> -z: rotation about z keeps the symmetry, so the force across vanishes.
TEST(SoftExperiment, AConfigurationSymmetricInZHasNoForceAcross) {
  const ShellPacking symmetric = by_hand({{{0.45, 0.0, 0.0}},
                                          {{-0.45, 0.1, 0.0}},
                                          {{0.05, 0.3, 0.45}},
                                          {{0.05, 0.3, -0.45}},
                                          {{0.0, -0.4, 0.4}},
                                          {{0.0, -0.4, -0.4}}},
                                         {0.5, 0.45, 0.4, 0.4, 0.35, 0.35});
  SoftExperiment e = make_soft_solid(small_spec(), symmetric, false);
  press(e, 0.25);
  EXPECT_LT(std::abs(e.force_on_second()[2]), 1e-6 * e.force_on_second()[0]);
  turn(e, 0.5);
  rest(e, 1e-6);
  EXPECT_GT(std::abs(e.force_on_second()[1]), 1e-3 * e.force_on_second()[0]);
  EXPECT_LT(std::abs(e.force_on_second()[2]), 1e-6 * e.force_on_second()[0]);
}

/// What is recorded: the states asked for, in order, the prestrain as angle 0.
TEST(SoftExperiment, AMeasurementRecordsItsPlan) {
  MeasurementState state;
  state.experiment = make_soft_solid(small_spec(), small_packing(0), false);
  const MeasurementPlan plan{{0.10, 0.20}, {0.20}, {-0.1, 0.1}, 0.05, true};
  int seen = 0;
  constexpr double kNever = 1e9;  // seconds between saves: at recorded points alone, however slow the machine is
  RunControl<MeasurementState> control{.seconds = kNever};
  control.progress = [&](const MeasurementState&, double share) { EXPECT_DOUBLE_EQ(share, 0.5 * ++seen); };
  measure(state, plan, *make_damped_protocol({}), control);
  EXPECT_EQ(seen, 2);
  ASSERT_EQ(state.run.normal.size(), 2U);
  EXPECT_EQ(state.run.normal[1].delta, 0.20);
  EXPECT_GT(state.run.normal[1].force, state.run.normal[0].force);
  ASSERT_EQ(state.run.tangential.size(), 3U);
  EXPECT_EQ(state.run.tangential[0].angle_deg, 0.0);
  EXPECT_LT(state.run.tangential[1].force_parallel, state.run.tangential[0].force_parallel);
  EXPECT_GT(state.run.tangential[2].force_parallel, state.run.tangential[0].force_parallel);
  EXPECT_NEAR(state.experiment.normal_overlap, 0.20 * state.experiment.spec.shell_radius, 1e-15);
}

/// Each angle starts afresh from the relaxed state: what another angle did before is not felt. A cumulative sweep goes
/// on from one to the next.
TEST(SoftExperiment, AnAngleDoesNotFeelTheOneBefore) {
  const auto at_the_last_angle = [](const std::vector<double>& angles, bool cumulative) {
    MeasurementState state;
    state.experiment = make_soft_solid(small_spec(), small_packing(0), false);
    MeasurementPlan plan{{0.25}, {0.25}, angles, 0.05, true};
    plan.cumulative = cumulative;
    measure(state, plan, *make_damped_protocol({.increment = 0.02}));
    return state.run.tangential.back();
  };
  const TangentialPoint alone = at_the_last_angle({0.2}, false);
  const TangentialPoint after = at_the_last_angle({0.03, 0.1, 0.2}, false);
  EXPECT_EQ(after.angle_deg, 0.2);
  EXPECT_EQ(after.force_parallel, alone.force_parallel);
  EXPECT_EQ(after.force_perpendicular, alone.force_perpendicular);
  EXPECT_NE(at_the_last_angle({0.03, 0.1, 0.2}, true).force_parallel, alone.force_parallel);
}

struct Mean {
  double sum = 0.0;
  double squares = 0.0;
  int n = 0;
  void add(double x) {
    sum += x;
    squares += x * x;
    ++n;
  }
  [[nodiscard]] double mean() const { return sum / n; }
  [[nodiscard]] double error() const { return std::sqrt((squares / n - mean() * mean()) / (n - 1)); }
};

/// The ensemble of packings knows no direction but the normal: without rotation both components across it average to
/// zero, and with it the one along the axis [SP 1.4]; the one that is dragged along does not.
TEST(SoftExperiment, TheForceAcrossTheRotationAveragesToZero) {
  constexpr int kPackings = 96;
  SoftParticleSpec spec;
  spec.trials = 200;
  spec.polydispersity = 5.0;
  Mean normal, before_y, before_z, across, dragged;
  for (std::uint64_t k = 0; k < kPackings; ++k) {
    SoftExperiment e = make_soft_solid(spec, generate_shell_packing(spec, 3, k), false);
    for (int step = 0; step < 15; ++step) {
      e.push(0.02 * spec.shell_radius);
      rest(e, step < 14 ? 0.1 : 1e-3);
    }
    const Vec3 before = e.force_on_second();
    normal.add(before[0]);
    before_y.add(before[1]);
    before_z.add(before[2]);
    Mean drags, pushes;  // both signs of one packing are one sample
    for (const double sign : {-1.0, 1.0}) {
      SoftExperiment turned = e;
      turn(turned, sign * 0.5);
      rest(turned, 1e-4);
      const Vec3 change = turned.force_on_second() - before;
      pushes.add(sign * change[2]);
      drags.add(sign * change[1]);
    }
    across.add(pushes.mean());
    dragged.add(drags.mean());
  }
  EXPECT_LT(std::abs(before_y.mean()), 3.0 * before_y.error());
  EXPECT_LT(std::abs(before_z.mean()), 3.0 * before_z.error());
  EXPECT_LT(std::abs(across.mean()), 3.0 * across.error()) << across.mean() << " +- " << across.error();
  EXPECT_LT(across.error(), 0.25 * dragged.mean()) << "or zero says nothing";
  EXPECT_LT(before_z.error(), 0.03 * normal.mean());
  EXPECT_GT(dragged.mean(), 5.0 * dragged.error());
}

}  // namespace
}  // namespace softgrain
