// The restitution asked for comes out, whatever the sizes and speeds. Convention: nothing is clipped, the contact ends
// at zero overlap (the dashpot may pull at the very end).
#include <gtest/gtest.h>

#include "tests/support/impact.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const Material kGlass{"glass", 2500.0, 7e10, 0.25, false};

ImpactOutcome normal_impact(const ImpactSetup& setup, const AnyLaw& law, double stiffness) {
  System3 s = impact_system(setup, law, kGlass);
  const HertzImpact elastic = hertz_impact(stiffness, effective_mass(s), setup.speed);
  return collide(s, setup.partner, elastic.duration / 500.0, 20000);
}

double hertz_stiffness(const ImpactSetup& setup) {
  return std::sqrt(effective_radius(setup)) * HertzCoefficients::of(kGlass, kGlass, 0.0, 1.0).inverse_d;
}

void expect_restitution(const ImpactSetup& setup, double e) {
  const AnyLaw law = hertz_law(HertzCoefficients::of(kGlass, kGlass, 0.0, e), false);
  const ImpactOutcome out = normal_impact(setup, law, hertz_stiffness(setup));
  EXPECT_TRUE(out.ended);
  EXPECT_NEAR(out.restitution, e, 5e-4) << "e " << e << ", ratio " << setup.ratio << ", speed " << setup.speed;
}

TEST(Restitution, HertzTsujiOverSizeRatioAndSpeed) {
  for (const double e : {0.1, 0.3, 0.5, 0.8, 0.95, 1.0})
    for (const double ratio : {1.0, 3.0, 100.0, 1000.0})
      for (const double speed : {1e-3, 0.1, 5.0}) expect_restitution({Partner::sphere, 0.01, ratio, speed}, e);
}

TEST(Restitution, HertzTsujiOnPlanesAndInsideShells) {
  for (const double e : {0.3, 0.8, 1.0})
    for (const double speed : {1e-3, 5.0}) {
      expect_restitution({Partner::plane, 0.01, 1.0, speed}, e);
      expect_restitution({Partner::shell_inside, 0.01, 1.5, speed}, e);
      expect_restitution({Partner::shell_inside, 0.01, 1000.0, speed}, e);
    }
}

TEST(Restitution, ZeroLeavesHardlyAnySpeed) {
  const ImpactSetup setup{Partner::sphere, 0.01, 2.0, 1.0};
  const AnyLaw law = hertz_law(HertzCoefficients::of(kGlass, kGlass, 0.0, 0.0), false);
  EXPECT_LT(std::abs(normal_impact(setup, law, hertz_stiffness(setup)).restitution), 0.01);
}

TEST(Restitution, LinearSpring) {
  for (const double e : {0.05, 0.5, 0.9, 1.0})
    for (const double speed : {1e-2, 1.0}) {
      const ImpactSetup setup{Partner::sphere, 0.01, 3.0, speed};
      System3 s = impact_system(setup, LinearSpring{1e6, 0.0, 0.0, LinearSpring::zeta(e)}, kGlass);
      const double period = std::numbers::pi * std::sqrt(effective_mass(s) / 1e6);
      EXPECT_NEAR(collide(s, setup.partner, period / 1000.0, 20000).restitution, e, 1e-3);
    }
}

}  // namespace
