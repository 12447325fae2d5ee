// Grains live in a shell from which a plane cuts a cap: whatever the plane does, none may leave the shell or pass the
// plane.
#include <gtest/gtest.h>

#include "common/dynamics/verlet.h"
#include "tests/support/small_packing.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr Slot kInner = 27;  // of shell_and_plane_system

/// Deepest penetration of an inner grain's surface beyond the shell, and of its centre beyond the plane.
void expect_inside(const System3& s, double shell_limit) {
  const auto& p = s.particles;
  const auto shell = static_cast<std::size_t>(p.grains);
  const Slot plane = p.first_plane();
  for (std::size_t u = 0; u < kInner; ++u) {
    EXPECT_LT(norm(p.sphere[u].x - p.sphere[shell].x) + p.sphere[u].r - p.sphere[shell].r, shell_limit)
        << "grain " << u;
    EXPECT_GT(dot(p.sphere[u].x - p.sphere[static_cast<std::size_t>(plane)].x, p.normal_of(plane)), 0.0)
        << "grain " << u;
  }
}

void push_plane(double friction, double restitution, double shell_limit) {
  System3 s = shell_and_plane_system<3>(friction, restitution, true);
  const auto plane = static_cast<std::size_t>(s.particles.first_plane());
  s.particles.velocity[plane][2] = 0.4;
  VelocityVerlet<3> integrator(2e-4);
  integrator.initialise(s);
  for (int k = 0; k < 4000; ++k) {
    integrator.step(s);
    if (k == 2500) s.particles.velocity[plane] = {};  // the plane now stands at z = -0.4
    if (k % 100 == 0) expect_inside(s, shell_limit);
  }
}

TEST(ShellCap, NoGrainLeavesWithoutFriction) { push_plane(0.0, 0.3, 0.02); }
TEST(ShellCap, NoGrainLeavesWithFriction) { push_plane(0.5, 0.3, 0.02); }
TEST(ShellCap, NoGrainLeavesElastic) { push_plane(0.3, 1.0, 0.04); }

/// A small grain in the wedge between shell and plane is driven out of it, or jams, but stays inside.
TEST(ShellCap, AGrainInTheWedgeStays) {
  for (const double friction : {0.0, 0.3, 1.0}) {
    System3 s = hertz_system<3>(friction, 0.5, true);
    const double r = 0.02;
    add_grain(s.particles, test_sphere<3>({{std::sqrt(0.978 * 0.978 - 0.57 * 0.57), 0.0, -0.57}}, r, 2500.0, 1));
    NewBody<3> shell;
    shell.r = 1.0;
    add_shell(s.particles, shell);
    NewBody<3> plane;
    plane.x[2] = -0.6;
    plane.velocity[2] = 0.2;
    add_plane(s.particles, plane, Vec3{{0.0, 0.0, 1.0}});
    VelocityVerlet<3> integrator(2e-5);
    integrator.initialise(s);
    for (int k = 0; k < 40000; ++k) {
      integrator.step(s);
      const auto& x = s.particles.sphere[0].x;
      ASSERT_LT(norm(x) + r, 1.0 + 0.2 * r) << "step " << k << ", mu " << friction;
      ASSERT_GT(x[2] - s.particles.sphere[2].x[2], 0.5 * r) << "step " << k << ", mu " << friction;
    }
  }
}

}  // namespace
