// The smallest self-stressed powder: a triangle of cohesive disks at rest, hit by a fourth that sticks and rolls into
// the groove. Five contacts with friction hold four disks once more than needed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/dynamics/verlet.h"
#include "microsim/powder/powder_rigidity.h"
#include "tests/support/disks.h"

namespace softgrain {
namespace {

using test::disks_by_hand;
using test::HandDisk;

PowderSpec rough(double kappa = 1e4) {
  PowderSpec spec;
  spec.stiffness = kappa;
  spec.friction = 0.5;
  return spec;
}

struct Impact {
  double speed;   ///< over V* = sqrt(F0 D0/m)
  double offset;  ///< of the path from the middle between the two disks that are hit
  std::array<double, 4> radius{0.5, 0.5, 0.5, 0.5};
  double kappa = 1e4;
};

/// Disks 0, 1, 2 in contact at N = 0; disk 3 comes from below.
System<2> before(const Impact& impact) {
  const PowderSpec spec = rough(impact.kappa);
  const auto [r0, r1, r2, r3] = impact.radius;
  const double overlap = 1.0 / spec.stiffness;
  const double a = r0 + r1 - overlap;
  const double b = r0 + r2 - overlap;
  const double c = r1 + r2 - overlap;
  const double x = (a * a + b * b - c * c) / (2.0 * a);
  System<2> s = disks_by_hand(spec, {{{{0.0, 0.0}}, r0},
                                     {{{a, 0.0}}, r1},
                                     {{{x, std::sqrt(b * b - x * x)}}, r2},
                                     {{{0.5 * a + impact.offset, -std::max(r0, r1) - r3}}, r3}});
  s.particles.velocity[3][1] = impact.speed * std::sqrt(spec.range);
  return s;
}

/// Takes away the motion of the whole as a rigid body, which nothing damps in free space.
void stop_rigid_motion(Particles<2>& p) {
  Vec<2> centre{};
  Vec<2> momentum{};
  double mass = 0.0;
  for (std::size_t u = 0; u < p.sphere.size(); ++u) {
    const double m = 1.0 / p.inverse_mass[u];
    mass += m;
    centre += p.sphere[u].x * m;
    momentum += p.velocity[u] * m;
  }
  centre *= 1.0 / mass;
  momentum *= 1.0 / mass;
  double turning = 0.0;
  double inertia = 0.0;
  for (std::size_t u = 0; u < p.sphere.size(); ++u) {
    const Vec<2> arm = p.sphere[u].x - centre;
    turning += (cross(arm, p.velocity[u] - momentum)[0]) / p.inverse_mass[u] + p.spin[u][0] / p.inverse_inertia[u];
    inertia += norm2(arm) / p.inverse_mass[u] + 1.0 / p.inverse_inertia[u];
  }
  const Vec<1> omega{{turning / inertia}};
  for (std::size_t u = 0; u < p.sphere.size(); ++u) {
    p.velocity[u] -= momentum + cross(omega, p.sphere[u].x - centre);
    p.spin[u] -= omega;
  }
}

/// Runs until the impact is over, then in the frame that does not turn until nothing moves.
void settle(System<2>& s, double kappa) {
  const double step = 0.1 / std::sqrt(kappa);
  VelocityVerlet<2> integrator(step);
  for (int part = 0; part < 4; ++part) {
    integrator.initialise(s);
    integrator.advance(s, std::lround(50.0 / step));
    stop_rigid_motion(s.particles);
  }
  integrator.initialise(s);
  integrator.advance(s, 1000);
}

System<2> after(const Impact& impact) {
  System<2> s = before(impact);
  settle(s, impact.kappa);
  return s;
}

/// Mean normal force of the contacts of both tips, disks 2 and 3, of equal disks.
double tip_force(const System<2>& s) {
  const auto pairs = powder_interactions(s, 1e-4);
  EXPECT_EQ(pairs.size(), 5U);
  double sum = 0.0;
  for (const auto& pair : pairs)
    if (std::max(pair.i, pair.j) > 1) sum += 0.25 * pair.normal_force;
  return sum;
}

double tip_force(double speed, double offset) {
  Impact impact{speed, offset};
  impact.kappa = 1e5;  // the published one
  return tip_force(after(impact));
}

/// A disk of radius R on two that touch, radii R1 and R2, without load: the forces of its two contacts are opposite and
/// so lie on the line through both contact points. With alpha the angle at its centre, that line makes (pi - alpha)/2
/// with both normals: |T/N| = cot(alpha/2). In the triangle of centres, of sides R + R1, R + R2, R1 + R2, half-angle
/// formula: tan^2(alpha/2) = R1 R2/(R (R + R1 + R2)).
double ratio(double r, double r1, double r2) { return std::sqrt(r * (r1 + r2 + r) / (r1 * r2)); }

void expect_double_triangle(const Impact& impact, double least_force) {
  const System<2> s = after(impact);
  EXPECT_LT(kinetic_energy(s.particles), 1e-16);
  const auto pairs = powder_interactions(s, 1e-4);
  ASSERT_EQ(pairs.size(), 5U) << "speed " << impact.speed << ", offset " << impact.offset;
  const PowderRigidity r = powder_rigidity(s, pairs, true);
  EXPECT_EQ(r.fixed.indeterminacy, 1);
  EXPECT_EQ(r.fixed.floppy, 3);
  EXPECT_FALSE(r.free.has_value());
  for (const Slot tip : {2, 3}) {
    double sum = 0.0;
    for (const auto& pair : pairs) {
      if (pair.i != tip && pair.j != tip) continue;
      EXPECT_FALSE(pair.distant);
      const double expected = ratio(impact.radius[static_cast<std::size_t>(tip)], impact.radius[0], impact.radius[1]);
      EXPECT_GT(pair.force(), least_force) << "self-stress";
      EXPECT_NEAR(std::abs(pair.tangential_force / pair.normal_force), expected, 5e-4 * expected) << "disk " << tip;
      sum += pair.tangential_force;
    }
    EXPECT_LT(std::abs(sum), 1e-8) << "opposite";
  }
}

TEST(DoubleTriangle, ForcesOfEqualDisksStandAtSixtyDegrees) {
  EXPECT_NEAR(ratio(0.5, 0.5, 0.5), std::sqrt(3.0), 1e-15);
  for (const double speed : {0.3, 1.0, 2.0})
    for (const double offset : {-0.2, 0.0, 0.3}) expect_double_triangle({speed, offset}, 1e-2);
}

TEST(DoubleTriangle, ForcesOfUnequalDisks) {
  expect_double_triangle({1.0, 0.1, {0.5, 0.4, 0.3, 0.35}}, 1e-2);
  expect_double_triangle({0.5, -0.1, {0.3, 0.45, 0.5, 0.25}}, 1e-2);
}

/// Without slip the self-stress follows from geometry. Its forces are N in the four contacts of the tips, -4 N between
/// the middle disks, |T| = sqrt 3 |N| at the tips. They do no work on compatible displacements, counted from the moment
/// when disk 3 touches: N/K_N at the two old contacts, (N + F0)/K_N at the two new ones, -4 N/K_N, T/K_T. So
/// (20 + 12 K_N/K_T) N = -2 F0: N = -F0/16 for K_T = K_N.
TEST(DoubleTriangle, ADiskPutDownAtRestLeavesASixteenthOfTheAdhesion) {
  for (const double stiffness_ratio : {1.0, 0.5}) {
    PowderSpec spec = rough(1e5);
    spec.friction = 10.0;
    spec.stiffness_ratio = stiffness_ratio;
    const double a = 1.0 - 1.0 / spec.stiffness;
    const double touch = 1.0 - 1e-9;
    System<2> s = disks_by_hand(spec, {{{{0.0, 0.0}}, 0.5},
                                       {{{a, 0.0}}, 0.5},
                                       {{{0.5 * a, std::sqrt(0.75) * a}}, 0.5},
                                       {{{0.5 * a, -std::sqrt(touch * touch - 0.25 * a * a)}}, 0.5}});
    settle(s, spec.stiffness);
    const double expected = -2.0 / (20.0 + 12.0 / stiffness_ratio);
    EXPECT_NEAR(tip_force(s), expected, 2e-3 * std::abs(expected)) << "K_T/K_N = " << stiffness_ratio;
  }
}

/// What an impact leaves depends on its speed and on the limit of friction. With mu times the elastic repulsion alone
/// [CP 3.1] gentle ones leave -0.10 to -0.115 F0; with mu times the damped normal force plus F0 it would be -0.125 to
/// -0.136 F0.
TEST(DoubleTriangle, GentleImpactsSlipAtTheElasticRepulsionAlone) {
  for (const double speed : {0.5, 1.0})
    for (const double offset : {0.1, 0.3}) {
      const double force = tip_force(speed, offset);
      EXPECT_LT(force, -0.100) << "speed " << speed << ", offset " << offset;
      EXPECT_GT(force, -0.115) << "speed " << speed << ", offset " << offset;
    }
}

/// Published: -0.133 F0, of disks thrown at 9.48 V* per component; the speed of that impact is not given.
TEST(DoubleTriangle, ImpactsOfThreeTimesTheSpeedLeaveThePublishedForce) {
  double mean = 0.0;
  for (const double offset : {0.2, 0.3, 0.35}) mean += tip_force(3.0, offset) / 3.0;
  EXPECT_NEAR(mean, -0.133, 0.006);
}

}  // namespace
}  // namespace softgrain
