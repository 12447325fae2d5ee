// Truncated power-law radii: closed forms of the distribution, and the exponent found back in samples with an honest
// error.
#include "common/packing/grading.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/core/error.h"
#include "common/core/random.h"

namespace softgrain {
namespace {

constexpr PowerLawRadii kPublished{3.5, 0.05, 0.5};

std::vector<double> sample(const PowerLawRadii& law, std::size_t count, std::uint64_t index) {
  RandomStream random(11, RandomPurpose::test, index);
  std::vector<double> radii;
  while (radii.size() < count) radii.push_back(law.radius(random.uniform()));
  return radii;
}

TEST(SizeDistribution, InverseCumulativeMeetsItsLimits) {
  // Near rmax the powers r^(1-b) are small differences of large numbers: a few tens of units in the last place.
  EXPECT_NEAR(kPublished.radius(0.0), kPublished.rmin, 1e-14 * kPublished.rmin);
  EXPECT_NEAR(kPublished.radius(1.0), kPublished.rmax, 1e-14 * kPublished.rmax);
  for (const double u : {0x1p-54, 0.5, 1.0 - 0x1p-53}) {
    EXPECT_GE(kPublished.radius(u), kPublished.rmin);
    EXPECT_LE(kPublished.radius(u), kPublished.rmax);
  }
}

TEST(SizeDistribution, InverseCumulativeAscends) {
  for (const double exponent : {1.5, 2.5, 3.5, 5.0}) {
    const PowerLawRadii law{exponent, 0.05, 0.5};
    for (int k = 0; k < 1000; ++k)
      EXPECT_LT(law.radius(k * 1e-3), law.radius((k + 1) * 1e-3)) << exponent << ", u = " << k * 1e-3;
  }
}

/// The complementary cumulative distribution is the integral of r^-b from r to rmax over that from rmin (Simpson's rule
/// here).
TEST(SizeDistribution, ShareAboveIsTheIntegralOfTheDensity) {
  const auto integral = [](double exponent, double low, double high) {
    constexpr int kSteps = 2000;  // in ln r
    const double width = std::log(high / low) / kSteps;
    double sum = 0.0;
    for (int k = 0; k <= kSteps; ++k) {
      const double weight = k == 0 || k == kSteps ? 1.0 : (k % 2 == 1 ? 4.0 : 2.0);
      sum += weight * std::pow(low * std::exp(k * width), 1.0 - exponent);
    }
    return sum * width / 3.0;
  };
  for (const double exponent : {1.5, 3.5}) {
    const PowerLawRadii law{exponent, 0.05, 0.5};
    for (const double r : {0.06, 0.1, 0.3, 0.49})
      EXPECT_NEAR(law.share_above(r), integral(exponent, r, law.rmax) / integral(exponent, law.rmin, law.rmax), 1e-10)
          << exponent << ", " << r;
  }
}

TEST(SizeDistribution, ShareAboveInvertsTheRadius) {
  for (const double u : {0.01, 0.3, 0.5, 0.9, 0.999})
    EXPECT_NEAR(kPublished.share_above(kPublished.radius(u)), 1.0 - u, 1e-12);
  EXPECT_EQ(kPublished.share_above(0.01), 1.0);
  EXPECT_EQ(kPublished.share_above(kPublished.rmin), 1.0);
  EXPECT_EQ(kPublished.share_above(kPublished.rmax), 0.0);
  EXPECT_EQ(kPublished.share_above(2.0), 0.0);
}

TEST(SizeDistribution, ExponentOfALargeSampleIsFoundBack) {
  for (const double exponent : {1.5, 2.5, 3.5}) {
    const ExponentFit fit = fit_exponent(sample({exponent, 0.05, 0.5}, 20000, 0));
    EXPECT_LT(fit.standard_error, 0.02) << exponent;
    EXPECT_NEAR(fit.exponent, exponent, 4.0 * fit.standard_error) << exponent;
  }
}

/// Scatter of the exponent over independent samples agrees with the standard error that each of them states. The
/// scatter of 50 numbers is itself known to 10 %: bounds at three of these, and the mean within four standard errors of
/// the mean.
TEST(SizeDistribution, StandardErrorIsTheScatterOverSamples) {
  constexpr int kSamples = 50;
  double mean = 0.0;
  double squares = 0.0;
  double stated = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const ExponentFit fit = fit_exponent(sample(kPublished, 2000, static_cast<std::uint64_t>(k + 1)));
    mean += (fit.exponent - 3.5) / kSamples;
    squares += (fit.exponent - 3.5) * (fit.exponent - 3.5);
    stated += fit.standard_error / kSamples;
  }
  const double scatter = std::sqrt((squares - kSamples * mean * mean) / (kSamples - 1));
  EXPECT_GT(scatter / stated, 0.7);
  EXPECT_LT(scatter / stated, 1.3);
  EXPECT_LT(std::abs(mean), 4.0 * stated / std::sqrt(1.0 * kSamples));
}

/// Known answer: density 1/r is uniform in ln r, so radii evenly spaced in ln r have exponent 1.
TEST(SizeDistribution, EvenLogarithmsHaveExponentOne) {
  std::vector<double> radii;
  for (int k = 0; k <= 100; ++k) radii.push_back(std::exp(0.02 * k));
  EXPECT_NEAR(fit_exponent(radii).exponent, 1.0, 1e-9);
  std::reverse(radii.begin(), radii.end());
  EXPECT_NEAR(fit_exponent(radii).exponent, 1.0, 1e-9);
}

TEST(SizeDistribution, ExponentDoesNotDependOnTheUnit) {
  std::vector<double> radii = sample(kPublished, 500, 7);
  const double metres = fit_exponent(radii).exponent;
  for (double& r : radii) r *= 1000.0;
  EXPECT_NEAR(fit_exponent(radii).exponent, metres, 1e-9);
}

TEST(SizeDistribution, TooFewOrEqualRadiiAreRefused) {
  EXPECT_THROW((void)fit_exponent({}), InputError);
  EXPECT_THROW((void)fit_exponent({1.0, 2.0}), InputError);
  EXPECT_THROW((void)fit_exponent({1.0, 1.0, 1.0}), InputError);
}

}  // namespace
}  // namespace softgrain
