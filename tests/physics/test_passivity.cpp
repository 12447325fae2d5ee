// Friction must not make energy. The rescaled spring never does; the published form does a little, and how much is known.
#include <gtest/gtest.h>

#include "tests/support/impact.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const Material kOxide{"oxide", 4000.0, 3.8e11, 0.23, false};

/// Energy after over before, for an impact at `degrees` from the normal with a backspin of `spin_share` of the sliding speed.
double energy_ratio(Partner partner, bool rescaled, double e, double friction, double degrees, double spin_share) {
  const double angle = degrees * std::numbers::pi / 180.0;
  ImpactSetup setup{partner, 0.0025, partner == Partner::shell_inside ? 3.0 : 2.0, 3.9 * std::cos(angle), 3.9 * std::sin(angle)};
  setup.spin[1] = -spin_share * setup.sliding_speed / setup.radius;
  const HertzCoefficients k = HertzCoefficients::of(kOxide, kOxide, friction, e);
  System3 s = impact_system(setup, hertz_law(k, rescaled), kOxide);
  const double duration = hertz_impact(std::sqrt(effective_radius(setup)) * k.inverse_d, effective_mass(s), setup.speed).duration;
  const ImpactOutcome out = collide(s, partner, duration / 4000.0, 40000);
  EXPECT_TRUE(out.ended);
  return out.energy_ratio;
}

template <class Use>
void over_impacts(Use&& use) {
  for (const Partner partner : {Partner::sphere, Partner::plane, Partner::shell_inside})
    for (const double friction : {0.092, 0.5})
      for (const double degrees : {5.0, 20.0, 45.0, 70.0, 85.0, 89.0})
        for (const double spin : {0.0, -0.9, 1.5}) use(partner, friction, degrees, spin);
}

TEST(Passivity, TheRescaledSpringNeverMakesEnergy) {
  over_impacts([](Partner partner, double friction, double degrees, double spin) {
    for (const double e : {1.0, 0.9, 0.5})
      EXPECT_LE(energy_ratio(partner, true, e, friction, degrees, spin), 1.0 + 1e-9)
          << "e " << e << ", mu " << friction << ", " << degrees << " degrees, spin " << spin;
  });
}

TEST(Passivity, WhatThePublishedSpringMakesIsBounded) {
  double most = 0.0;
  over_impacts([&](Partner partner, double friction, double degrees, double spin) {
    most = std::max(most, energy_ratio(partner, false, 1.0, friction, degrees, spin) - 1.0);
  });
  RecordProperty("largest_creation", std::to_string(most));
  EXPECT_GT(most, 1e-4) << "if this form has become passive, say so in the documentation";
  EXPECT_LT(most, 0.02);
}

}  // namespace
