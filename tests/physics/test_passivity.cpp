// Friction must not make energy. The rescaled spring never does; the published form does a little, and how much is
// known.
#include <gtest/gtest.h>

#include "tests/support/impact.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

const Material kOxide{"oxide", 4000.0, 3.8e11, 0.23, false};

/// Energy after over before, for an impact at `degrees` from the normal with a backspin of `spin_share` of the sliding
/// speed.
double energy_ratio(const Material& material, Partner partner, bool rescaled, double e, double friction, double degrees,
                    double spin_share) {
  const double angle = degrees * std::numbers::pi / 180.0;
  ImpactSetup setup{partner, 0.0025, partner == Partner::shell_inside ? 3.0 : 2.0, 3.9 * std::cos(angle),
                    3.9 * std::sin(angle)};
  setup.spin[1] = -spin_share * setup.sliding_speed / setup.radius;
  const HertzCoefficients k = HertzCoefficients::of(material, material, friction, e);
  System3 s = impact_system(setup, hertz_law(k, rescaled), material);
  const double duration =
      hertz_impact(std::sqrt(effective_radius(setup)) * k.inverse_d, effective_mass(s), setup.speed).duration;
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
      EXPECT_LE(energy_ratio(kOxide, partner, true, e, friction, degrees, spin), 1.0 + 1e-9)
          << "e " << e << ", mu " << friction << ", " << degrees << " degrees, spin " << spin;
  });
}

/// Largest share of energy that the published form makes on a plane, over angles and spins.
double largest_creation(double friction) {
  const Material worst{"worst", 4000.0, 3.8e11, 0.0, false};  // of Poisson's ratios 0, 0.23, 0.45
  double most = 0.0;
  for (const double degrees : {1.0, 5.0, 13.0, 29.0, 49.0, 69.0, 85.0})
    for (const double spin : {-1.0, 0.0, 1.5, 2.0, 3.0})
      most = std::max(most, energy_ratio(worst, Partner::plane, false, 1.0, friction, degrees, spin) - 1.0);
  return most;
}

TEST(Passivity, WhatThePublishedSpringMakesIsBounded) {
  // Measured on a fine grid of angles, spins and Poisson's ratios: 0.015 %, 0.13 %, 0.37 %, 1.3 % (and 8.6 % at mu =
  // 5).
  const std::vector<std::pair<double, double>> bounds{{0.1, 2e-4}, {0.3, 1.5e-3}, {0.5, 4e-3}, {1.0, 1.5e-2}};
  for (const auto& [friction, bound] : bounds) {
    const double most = largest_creation(friction);
    EXPECT_LT(most, bound) << "mu " << friction;
    EXPECT_GT(most, 0.25 * bound) << "mu " << friction
                                  << ": if this form has become passive, say so in the documentation";
  }
}

}  // namespace
