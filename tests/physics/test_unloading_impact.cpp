// Impacts of soft particles that unload along a branch: the work that comes back, closed form, and a restart on the
// way.
#include <gtest/gtest.h>

#include <cmath>

#include "common/state/system_io.h"
#include "tests/support/impact.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const Material kSoftMatter{"soft", 2500.0, 1e6, 0.3, false};

SoftUnloading law_of(Partner partner, double b, double delta, const UnloadingBranch& branch) {
  SoftUnloading law;
  law.normal = threshold_term(1.0, b, delta);
  law.tangential = threshold_term(0.5, 1.0, delta);
  law.delta = delta;
  law.modulus = 1e6;
  law.friction = 0.3;
  law.partner_is_soft = partner == Partner::sphere;
  law.branch = branch;
  return law;
}

/// Share of the work of loading to X that a way back along the branch gives: F(X) (1 - r)(X - delta)/(m + 1) over the
/// integral of F.
double returned_share(double b, double delta, const UnloadingBranch& u, double deepest) {
  const double threshold = std::pow(delta, b);
  const double force = std::pow(deepest, b) - threshold;
  const double work = (std::pow(deepest, b + 1.0) - threshold * delta) / (b + 1.0) - threshold * (deepest - delta);
  return force * (1.0 - u.residual) * (deepest - delta) / ((u.exponent + 1.0) * work);
}

TEST(UnloadingImpact, KineticEnergyIsTheWorkThatComesBack) {
  for (const Partner partner : {Partner::sphere, Partner::plane})
    for (const double delta : {0.0, 0.03})
      for (const UnloadingBranch u :
           {UnloadingBranch{0.0, 2.0}, UnloadingBranch{0.2, 2.0}, UnloadingBranch{0.6, 1.0}}) {
        const ImpactSetup setup{partner, 0.01, 1.0, 0.3, 0.0, {}};
        System3 s = impact_system(setup, law_of(partner, 2.0, delta, u), kSoftMatter);
        const ImpactOutcome out = collide(s, partner, 2e-6, 40000);
        ASSERT_TRUE(out.ended);
        const double momentum_share = partner == Partner::sphere ? 0.5 : 1.0;  // of the energy, that of the approach
        const double expected =
            1.0 - momentum_share * (1.0 - returned_share(2.0, delta, u, out.max_overlap / setup.radius));
        EXPECT_NEAR(out.energy_ratio, expected, 2e-3) << delta << " " << u.residual << " " << u.exponent;
      }
}

/// With friction, at any angle: nothing is gained.
TEST(UnloadingImpact, ObliqueImpactsGainNoEnergy) {
  for (const double across : {0.05, 0.3, 1.0})
    for (const double b : {1.5, 2.8}) {
      const UnloadingBranch u{0.1, least_unloading_exponent(0.1, b)};
      System3 s = impact_system({Partner::plane, 0.01, 1.0, 0.3, across, {{5.0, -10.0, 0.0}}},
                                law_of(Partner::plane, b, 0.02, u), kSoftMatter);
      const ImpactOutcome out = collide(s, Partner::plane, 2e-6, 40000);
      EXPECT_TRUE(out.ended);
      EXPECT_LT(out.energy_ratio, 1.0);
    }
}

/// The deepest overlap is history: it is saved, and a run that goes on has the same bits.
TEST(UnloadingImpact, ARestartKnowsTheDeepestOverlap) {
  System3 s = impact_system({Partner::sphere, 0.01, 1.0, 0.3, 0.1, {}}, law_of(Partner::sphere, 2.0, 0.03, {0.2, 2.0}),
                            kSoftMatter);
  VelocityVerlet<3> integrator(2e-6);
  integrator.initialise(s);
  double deepest = 0.0;
  double now = 0.0;
  for (int k = 0; k < 20000 && !(now < 0.9 * deepest); ++k) {
    integrator.step(s);
    now = overlap_of(s, Partner::sphere);
    deepest = std::max(deepest, now);
  }
  ASSERT_LT(now, 0.9 * deepest) << "it must be on its way back";
  ASSERT_EQ(s.contacts.memory.size(), 1U);
  EXPECT_NEAR(s.contacts.memory[0], deepest, 1e-9);
  const TemporaryDirectory directory;
  {
    h5::AtomicFile file(directory.file("state.h5"));
    write_system(file.root().create("state"), s);
    file.commit();
  }
  System3 read;
  read.materials = s.materials;
  read.laws = s.laws;
  read_system(h5::open_file(directory.file("state.h5")).open("state"), read);
  EXPECT_EQ(read.contacts.memory, s.contacts.memory);
  VelocityVerlet<3> other(2e-6);
  for (int k = 0; k < 500; ++k) {
    integrator.step(s);
    other.step(read);
  }
  EXPECT_EQ(read.particles.velocity[0], s.particles.velocity[0]);
  EXPECT_EQ(read.particles.sphere[0].x, s.particles.sphere[0].x);
}

}  // namespace
