// What is not a number is never lost on its way to whoever judges a state: it counts as the worst.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/core/error.h"
#include "common/core/limits.h"
#include "common/dynamics/verlet.h"
#include "common/statics/minimiser.h"
#include "microsim/particles/guards.h"
#include "microsim/powder/powder_assembly.h"
#include "tests/support/disks.h"
#include "tests/support/small_packing.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(NotANumber, IsTheLargest) {
  EXPECT_EQ(larger_or_nan(1.0, 2.0), 2.0);
  EXPECT_EQ(larger_or_nan(2.0, 1.0), 2.0);
  EXPECT_TRUE(std::isnan(larger_or_nan(kNaN, 1.0)));
  EXPECT_TRUE(std::isnan(larger_or_nan(1.0, kNaN)));
}

TEST(NotANumber, InAVelocityEndsTheStep) {
  System3 s = shell_and_plane_system<3>(0.3, 0.8, false);
  VelocityVerlet<3> integrator(1e-5);
  integrator.initialise(s);
  integrator.advance(s, 3);
  s.particles.velocity[4][1] = kNaN;
  EXPECT_THROW(integrator.advance(s, 1), UnusableResult);
}

TEST(NotANumber, InAPlaceEndsTheNextSteps) {
  System3 s = hertz_system<3>(0.3, 0.8, false);
  for (const Vec3& x : shaken_lattice<3>({}, 0.19, 3, 1)) add_grain(s.particles, test::test_sphere(x, 0.1, 2500.0));
  VelocityVerlet<3> integrator(1e-5);
  integrator.initialise(s);
  s.particles.sphere[13].x[0] = kNaN;
  EXPECT_THROW(integrator.advance(s, 2), UnusableResult);
}

TEST(NotANumber, InAForceIsTheResidualOfAPowder) {
  PowderSpec spec;
  System<2> s = disks_by_hand(spec, {{{{0.0, 0.0}}}, {{{5.0, 0.0}}}, {{{9.0, 0.0}}}});
  for (std::size_t lost = 0; lost < 3; ++lost) {
    s.particles.force.assign(3, Vec<2>{{0.1, 0.2}});
    s.particles.torque.assign(3, {});
    s.particles.force[lost][0] = kNaN;
    s.particles.torque[lost][0] = kNaN;
    const auto r = powder_residual(s, {{1.0, 1.0}}, {{1.0, lost == 0 ? kNaN : 1.0}}, 1.0, 1.0, true);
    EXPECT_TRUE(std::isnan(r.force)) << lost;
    EXPECT_TRUE(std::isnan(r.moment)) << lost;
    EXPECT_EQ(std::isnan(r.pressure), lost == 0);
  }
}

TEST(NotANumber, InAForceIsTheResidualOfAPack) {
  GrainPack pack;
  pack.radius.assign(3, 1e-3);
  statics::PackForces forces;
  forces.largest2.assign(3, 4.0);
  for (std::size_t lost = 0; lost < 9; ++lost) {
    forces.force.assign(9, 0.5);
    EXPECT_NEAR(statics::worst_residual(forces, pack, 3, 0.0), 0.5 * std::sqrt(3.0) / 2.0, 1e-15);
    forces.force[lost] = kNaN;
    EXPECT_TRUE(std::isnan(statics::worst_residual(forces, pack, 3, 0.0))) << lost;
  }
}

/// A wall that its load moves is no grain: only its guard sees where it is.
TEST(NotANumber, InTheWayOfAWallStopsTheRun) {
  System3 s = hertz_system<3>(0.3, 0.8, false);
  add_grain(s.particles, test::test_sphere<3>({}, 0.1, 2500.0));
  NewBody<3> lid;
  lid.x = {{0.0, 0.0, 0.2}};
  lid.mass = 1.0;
  add_plane(s.particles, lid, {{0.0, 0.0, -1.0}});
  VelocityVerlet<3>(1e-5).initialise(s);
  Guards<3> guards({}, s);
  EXPECT_NO_THROW(guards.look(s));
  s.particles.sphere[1].x[2] = kNaN;
  EXPECT_THROW(guards.look(s), UnusableResult);
}

}  // namespace
