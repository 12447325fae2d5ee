// Selective mass scaling: raises what is too quick, nothing else, and gives everything back.
#include "common/dynamics/slow_dynamics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/dynamics/force_pass.h"
#include "tests/support/small_packing.h"

namespace softgrain {
namespace {

constexpr double kFraction = 0.5;

System3 pack() { return test::shell_and_plane_system<3>(0.3, 0.5, false); }

TEST(ScaledMasses, EveryBodyIsSlowEnoughAndOnlyQuickOnesAreRaised) {
  System3 s = pack();
  BodyStiffness stiffness;
  force_pass(s, 0.0, stiffness);
  const auto before = s.particles.inverse_mass;
  double dt = 0.0;  // the step that suits the first grain in contact
  for (std::size_t u = 0; u < before.size() && dt == 0.0; ++u)
    if (before[u] > 0.0 && stiffness.translation[u] > 0.0)
      dt = kFraction / std::sqrt(stiffness.translation[u] * before[u]);
  ASSERT_GT(dt, 0.0);
  const ScaledMasses<3> raised(s, dt, kFraction);
  int changed = 0;
  for (std::size_t u = 0; u < before.size(); ++u) {
    EXPECT_LE(s.particles.inverse_mass[u], before[u]);
    EXPECT_LE(dt * std::sqrt(stiffness.translation[u] * s.particles.inverse_mass[u]), kFraction * (1.0 + 1e-12));
    changed += s.particles.inverse_mass[u] < before[u] ? 1 : 0;
  }
  EXPECT_GT(changed, 0);
}

TEST(ScaledMasses, AShortStepRaisesNothing) {
  System3 s = pack();
  const auto before = s.particles.inverse_mass;
  const ScaledMasses<3> raised(s, 1e-12, kFraction);
  EXPECT_EQ(s.particles.inverse_mass, before);
}

TEST(ScaledMasses, GivesEverythingBack) {
  System3 s = pack();
  force_pass(s, 0.0);
  System3 copy = s;
  { const ScaledMasses<3> raised(s, 1.0, kFraction); }
  EXPECT_EQ(s.particles.inverse_mass, copy.particles.inverse_mass);
  EXPECT_EQ(s.particles.inverse_inertia, copy.particles.inverse_inertia);
  force_pass(s, 0.0);
  force_pass(copy, 0.0);
  test::expect_same_bits(s.particles.force, copy.particles.force, "force");
}

}  // namespace
}  // namespace softgrain
