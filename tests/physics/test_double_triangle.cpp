// The smallest self-stressed powder: a triangle of cohesive disks at rest, hit by a fourth that sticks and rolls into
// the groove. Five contacts with friction hold four disks once more than needed.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "common/dynamics/verlet.h"
#include "microsim/powder/powder_rigidity.h"
#include "tests/support/disks.h"

namespace softgrain {
namespace {

using test::disks_by_hand;
using test::HandDisk;

PowderSpec rough() {
  PowderSpec spec;
  spec.stiffness = 1e4;
  spec.friction = 0.5;
  return spec;
}

struct Impact {
  double speed;   ///< over V* = sqrt(F0 D0/m)
  double offset;  ///< of the path from the middle between the two disks that are hit
  std::array<double, 4> radius{0.5, 0.5, 0.5, 0.5};
};

/// Disks 0, 1, 2 in contact at N = 0; disk 3 comes from below.
System<2> before(const Impact& impact) {
  const PowderSpec spec = rough();
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
System<2> after(const Impact& impact) {
  System<2> s = before(impact);
  VelocityVerlet<2> integrator(1e-3);
  for (int part = 0; part < 4; ++part) {
    integrator.initialise(s);
    integrator.advance(s, 50000);
    stop_rigid_motion(s.particles);
  }
  integrator.initialise(s);
  integrator.advance(s, 1000);
  return s;
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

}  // namespace
}  // namespace softgrain
