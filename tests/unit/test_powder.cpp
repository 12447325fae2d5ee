// Powders in two dimensions: how a sample starts and how its contacts are counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/core/error.h"
#include "common/neighbours/verlet_list.h"
#include "microsim/powder/powder_analysis.h"
#include "microsim/powder/powder_contacts.h"
#include "microsim/powder/powder_start.h"

namespace softgrain {
namespace {

PowderSpec small(double fraction) {
  PowderSpec spec;
  spec.disks = 200;
  spec.solid_fraction = fraction;
  spec.stiffness = 1e4;
  return spec;
}

TEST(PowderStart, FractionDiametersAndMassesAreAsAsked) {
  for (const double fraction : {0.13, 0.36, 0.52}) {
    const System<2> s = make_powder(small(fraction), 1, 0);
    EXPECT_NEAR(powder_fraction(s), fraction, 1e-12);
    double mean = 0.0;
    for (std::size_t u = 0; u < 200; ++u) {
      const double d = 2.0 * s.particles.sphere[u].r;
      EXPECT_GE(d, 0.5);
      EXPECT_LE(d, 1.0);
      EXPECT_NEAR(s.particles.inverse_mass[u], 1.0 / (d * d), 1e-12);
      EXPECT_NEAR(s.particles.inverse_inertia[u], 8.0 / (d * d * d * d), 1e-9);
      mean += d / 200.0;
    }
    EXPECT_NEAR(mean, 0.75, 4.0 * 0.144 / std::sqrt(200.0));
  }
}

TEST(PowderStart, NoDiskIsWithinReachOfAnother) {
  const System<2> s = make_powder(small(0.52), 3, 1);
  const double edge = s.cell.edges[0][0];
  for (std::size_t i = 0; i < 200; ++i)
    for (std::size_t j = i + 1; j < 200; ++j) {
      Vec<2> apart = s.particles.sphere[i].x - s.particles.sphere[j].x;
      for (int k = 0; k < 2; ++k) apart[k] -= edge * std::round(apart[k] / edge);
      EXPECT_GT(norm(apart), s.particles.sphere[i].r + s.particles.sphere[j].r + 1e-3);
    }
  EXPECT_THROW((void)make_powder(small(0.80), 1, 0), InputError);
}

/// V0 belongs to each component [CP 3.3], 0.3 a/T0 for 9.48 V*: |v| has a root mean square of sqrt 2 V0.
TEST(PowderStart, ComponentsOfVelocitiesHaveTheSpeedAndNoMomentum) {
  PowderSpec spec = small(0.36);
  spec.start_speed = 9.48;
  const System<2> s = make_powder(spec, 1, 0);
  Vec<2> momentum{};
  Vec<2> square{};
  for (std::size_t u = 0; u < 200; ++u) {
    const Vec<2>& v = s.particles.velocity[u];
    momentum += v * (1.0 / s.particles.inverse_mass[u]);
    for (int k = 0; k < 2; ++k) square[k] += v[k] * v[k] / 200.0;
    EXPECT_EQ(s.particles.spin[u][0], 0.0);
  }
  const double v0 = 9.48 * std::sqrt(1e-3);
  EXPECT_NEAR(v0, 0.3, 3e-4);
  EXPECT_LT(norm(momentum), 1e-12);
  EXPECT_NEAR(std::sqrt(0.5 * (square[0] + square[1])), v0, 1e-12);
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(std::sqrt(square[k]), v0, 0.15 * v0) << "200 disks";
}

/// Maxwell: every component of sqrt(m) v is normal with one variance, that of equal mean energies, <m v_x^2> =
/// V0^2/<1/m>. Kolmogorov-Smirnov distance of the components of 3000 disks, below the 1 % limit of 1.63/sqrt n.
TEST(PowderStart, VelocitiesAreMaxwellian) {
  PowderSpec spec = small(0.36);
  spec.disks = 3000;
  spec.start_speed = 9.48;
  const System<2> s = make_powder(spec, 5, 0);
  double inverse_mass = 0.0;
  for (const double m : s.particles.inverse_mass) inverse_mass += m / 3000.0;
  const double sigma = 9.48 * std::sqrt(1e-3) / std::sqrt(inverse_mass);
  std::vector<double> scaled;
  for (std::size_t u = 0; u < 3000; ++u)
    for (int k = 0; k < 2; ++k)
      scaled.push_back(s.particles.velocity[u][k] / std::sqrt(s.particles.inverse_mass[u]) / sigma);
  std::sort(scaled.begin(), scaled.end());
  double distance = 0.0;
  const auto n = static_cast<double>(scaled.size());
  for (std::size_t k = 0; k < scaled.size(); ++k) {
    const double normal = 0.5 * std::erfc(-scaled[k] / std::numbers::sqrt2);
    distance = std::max(distance, std::abs(normal - (static_cast<double>(k) + 0.5) / n));
  }
  EXPECT_LT(distance, 1.63 / std::sqrt(n));
}

System<2> by_hand(const PowderSpec& spec, const std::vector<Vec<2>>& x) {
  System<2> s;
  s.materials = {{"disk", 1.0, 1.0, 0.3, false}};
  s.laws = LawSet(1);
  s.laws.set(0, 0, powder_law(spec));
  s.cell = box_cell<2>({{20.0, 20.0}}, {true, true});
  for (const Vec<2>& at : x) {
    NewBody<2> disk;
    disk.x = at;
    disk.r = 0.5;
    disk.mass = 1.0;
    disk.inertia = 0.125;
    add_grain(s.particles, disk);
  }
  return s;
}

/// A chain: contact under tension, contact pressed, a distant pair, and one disk alone; the chain crosses the boundary.
TEST(PowderContacts, CountsAndForces) {
  PowderSpec spec = small(0.36);
  const std::vector<Vec<2>> x{{{18.6, 5.0}}, {{19.59995, 5.0}}, {{0.59975, 5.0}}, {{1.60025, 5.0}}, {{10.0, 10.0}}};
  const PowderContacts c = powder_contacts(by_hand(spec, x), 1e-4, true);
  EXPECT_EQ(c.contacts, 2);
  EXPECT_EQ(c.distant, 1);
  EXPECT_NEAR(c.coordination, 6.0 / 5.0, 1e-15);
  ASSERT_EQ(c.shares.size(), 3U);
  EXPECT_NEAR(c.shares[0], 0.2, 1e-15);
  EXPECT_NEAR(c.shares[1], 0.4, 1e-15);
  EXPECT_NEAR(c.shares[2], 0.4, 1e-15);
  EXPECT_EQ(c.repulsive, 1);  // overlap 2e-4: 2 - 1
  EXPECT_EQ(c.tensile, 2);    // overlap 5e-5: 0.5 - 1; gap 5e-4: -0.5
  EXPECT_NEAR(c.mean_repulsive, 1.0, 1e-9);
  EXPECT_NEAR(c.mean_tensile, -0.5, 1e-9);
  EXPECT_NEAR(c.mean_normal, 0.0, 1e-9);
  EXPECT_NEAR(c.square_mean_normal, std::sqrt(1.5 / 3.0), 1e-9);
  EXPECT_NEAR(c.coordination_backbone, 1.2 / 0.8, 1e-12);
}

/// A force of 5e-3 F0 counts, with rolling resistance as without: 1e-2 is but a colour of pictures.
TEST(PowderContacts, ForcesCountFromTheSameLimitWithRollingResistance) {
  PowderSpec spec = small(0.36);
  for (const bool rolling : {false, true}) {
    spec.rolling = rolling;
    const System<2> s =
        by_hand(spec, {{{5.0, 5.0}}, {{6.0 - 1.005e-4, 5.0}}, {{9.0, 9.0}}, {{10.0 - 1.00005e-4, 9.0}}});
    const PowderAnalysis a = analyse_powder(s, spec, 0.0, false);
    EXPECT_EQ(a.zero, 1e-4);
    EXPECT_EQ(a.contacts.repulsive, 1);
    EXPECT_EQ(a.contacts.unstressed, 1);
    EXPECT_EQ(a.forces.zero_share, 0.5);
  }
}

TEST(PowderContacts, RattlersAreTakenAwayOneAfterAnother) {
  PowderSpec spec = small(0.36);
  spec.cohesive = false;
  const double h = 0.999 * std::sqrt(0.75);
  // A triangle with a tail of two, and one alone: the tail goes link by link.
  const std::vector<Vec<2>> x{{{5.0, 5.0}},   {{5.999, 5.0}}, {{5.4995, 5.0 + h}},
                              {{6.998, 5.0}}, {{7.997, 5.0}}, {{12.0, 12.0}}};
  const PowderContacts c = powder_contacts(by_hand(spec, x), 1e-4, false);
  EXPECT_EQ(c.contacts, 5);
  EXPECT_EQ(c.rattlers, 3);
}

/// Rumpf: with one contact of force N between two equal disks P = 2 N d Phi/(2 pi d^2)... = N d/A.
TEST(PowderContacts, RumpfPressureOfOnePair) {
  PowderSpec spec = small(0.36);
  const PowderContacts c = powder_contacts(by_hand(spec, {{{5.0, 5.0}}, {{5.9997, 5.0}}}), 1e-4, true);
  EXPECT_NEAR(c.mean_normal, 2.0, 1e-9);  // overlap 3e-4: 3 - 1
  EXPECT_NEAR(c.rumpf_pressure, 0.5 * 2.0 * 1.0 / 400.0, 1e-9);
}

}  // namespace
}  // namespace softgrain
