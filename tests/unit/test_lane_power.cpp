// Powers of several numbers at once, against one after the other.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "common/core/lanes.h"
#include "common/core/random.h"

namespace {

using namespace softgrain;

constexpr std::size_t kMany = 8;
using Eight = std::array<double, kMany>;

Eight powers(const Eight& x, const Eight& y) {
  Eight out{};
  powers_of(x.data(), y.data(), out.data(), kMany);
  return out;
}

/// Overlaps and exponents of soft laws, and far beyond.
TEST(LanePower, IsThePowerToFourUnitsInTheLastPlace) {
  RandomStream random(1, RandomPurpose::test, 0);
  double worst = 0.0;
  for (int round = 0; round < 20000; ++round) {
    Eight x{}, y{};
    for (std::size_t k = 0; k < kMany; ++k) {
      x[k] = std::pow(10.0, -8.0 * random.uniform());
      y[k] = -2.0 + 10.0 * random.uniform();
    }
    const Eight out = powers(x, y);
    for (std::size_t k = 0; k < kMany; ++k) worst = std::max(worst, std::abs(out[k] / std::pow(x[k], y[k]) - 1.0));
  }
  EXPECT_LT(worst, 4.5 * std::numeric_limits<double>::epsilon());
}

TEST(LanePower, ALaneKnowsNothingOfItsPlace) {
  const Eight x{0.1, 0.11, 0.2, 0.3, 0.017, 0.5, 0.9, 1e-6};
  const Eight y{2.5, 1.7, 3.0, 4.1, 1.0, 0.5, 6.0, 1.2};
  const Eight out = powers(x, y);
  for (std::size_t shift = 1; shift < kMany; ++shift) {
    Eight turned_x{}, turned_y{};
    for (std::size_t k = 0; k < kMany; ++k) {
      turned_x[k] = x[(k + shift) % kMany];
      turned_y[k] = y[(k + shift) % kMany];
    }
    const Eight turned = powers(turned_x, turned_y);
    for (std::size_t k = 0; k < kMany; ++k) EXPECT_EQ(turned[k], out[(k + shift) % kMany]) << shift << ' ' << k;
  }
}

TEST(LanePower, EdgesAreThoseOfThePlainPower) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const double endless = std::numeric_limits<double>::infinity();
  const Eight out =
      powers({0.0, 1.0, -1.0, none, endless, 1e-310, 2.0, 0.0}, {2.5, 3.0, 2.5, 1.0, 2.0, 0.5, -1.0, 0.0});
  EXPECT_EQ(out[0], 0.0);
  EXPECT_EQ(out[1], 1.0);
  EXPECT_TRUE(std::isnan(out[2]));
  EXPECT_TRUE(std::isnan(out[3]));
  EXPECT_EQ(out[4], endless);
  EXPECT_NEAR(out[5] / 1e-155, 1.0, 1e-12);
  EXPECT_EQ(out[6], 0.5);
  EXPECT_EQ(out[7], 1.0);
}

}  // namespace
