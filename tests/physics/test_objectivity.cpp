// Turning the whole system turns its forces, torques and histories, and nothing else.
#include <gtest/gtest.h>

#include "common/dynamics/force_pass.h"
#include "tests/support/impact.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const Vec3 kAxis = Vec3{{1.0, -2.0, 2.0}} * (1.0 / 3.0);
constexpr double kAngle = 1.1;

Vec3 turned(const Vec3& v) { return rotate(v, kAxis, kAngle); }

System3 turned(System3 s) {
  auto& p = s.particles;
  for (auto& sphere : p.sphere) sphere.x = turned(sphere.x);
  for (auto* vectors : {&p.velocity, &p.spin, &s.contacts.spring})
    for (Vec3& v : *vectors) v = turned(v);
  for (Vec3& v : p.plane_normal) v = turned(v);
  s.gravity = turned(s.gravity);
  s.neighbours.reference.clear();  // the list must be made again
  return s;
}

void expect_turned(const std::vector<Stored<3>>& from, const std::vector<Stored<3>>& to, double tolerance) {
  double scale = 0.0;
  for (const Vec3& v : from) scale = std::max(scale, norm(v));
  ASSERT_GT(scale, 0.0);
  for (std::size_t u = 0; u < from.size(); ++u) EXPECT_LT(norm(turned(from[u]) - to[u]), tolerance * scale) << u;
}

TEST(Objectivity, ForcesAndTorquesTurnWithTheSystem) {
  for (const bool rescaled : {false, true}) {
    System3 s = shell_and_plane_system<3>(0.4, 0.7, rescaled);
    VelocityVerlet<3> integrator(1e-4);
    integrator.initialise(s);
    for (int k = 0; k < 400; ++k) integrator.step(s);
    System3 other = turned(s);
    force_pass(s, 1e-4);
    force_pass(other, 1e-4);
    expect_turned(s.particles.force, other.particles.force, 1e-9);
    expect_turned(s.particles.torque, other.particles.torque, 1e-9);
  }
}

TEST(Objectivity, AnImpactGoesTheSameWayInEveryDirection) {
  const Material glass{"glass", 2500.0, 1e8, 0.25, false};
  System3 s = impact_system({Partner::sphere, 0.01, 2.0, 0.5, 0.8, {{10.0, -30.0, 20.0}}},
                            hertz_law(HertzCoefficients::of(glass, glass, 0.5, 0.8), false), glass);
  System3 other = turned(s);
  VelocityVerlet<3> integrator(1e-6);
  VelocityVerlet<3> second(1e-6);
  integrator.initialise(s);
  second.initialise(other);
  for (int k = 0; k < 1500; ++k) {
    integrator.step(s);
    second.step(other);
  }
  expect_turned(s.particles.velocity, other.particles.velocity, 1e-9);
  expect_turned(s.particles.spin, other.particles.spin, 1e-9);
}

/// Galilei: adding a velocity to everything changes no force.
TEST(Objectivity, AMovingObserverSeesTheSameForces) {
  System3 s = shell_and_plane_system<3>(0.4, 0.7, false);
  VelocityVerlet<3> integrator(1e-4);
  integrator.initialise(s);
  for (int k = 0; k < 400; ++k) integrator.step(s);
  System3 moving = s;
  for (Vec3& v : moving.particles.velocity) v += Vec3{{3.0, -1.0, 2.0}};
  force_pass(s, 1e-4);
  force_pass(moving, 1e-4);
  double scale = 0.0;
  for (const Vec3& f : s.particles.force) scale = std::max(scale, norm(f));
  for (std::size_t u = 0; u < s.particles.force.size(); ++u)
    EXPECT_LT(norm(s.particles.force[u] - moving.particles.force[u]), 1e-9 * scale);
}

}  // namespace
