// The compressible packing model of de Larrard against its closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calibrate/compressible_packing.h"
#include "common/core/error.h"

namespace softgrain {
namespace {

constexpr double kBeta = 0.74;

TEST(CompressiblePacking, EqualGrainsFollowTheirClosedForm) {
  for (const double index : {0.5, kPouringIndex, 6.7, kVibratedPressedIndex, 1e6}) {
    const double phi = compressible_packing({{2.0, 1.0, kBeta}}, index);
    EXPECT_NEAR(phi, kBeta / (1.0 + 1.0 / index), 1e-11) << index;
    EXPECT_NEAR(virtual_fraction_of(phi, index), kBeta, 1e-11) << index;
  }
}

/// A class in two halves is the class: a = b = 1 for equal diameters.
TEST(CompressiblePacking, PartsOfOneClassAreThatClass) {
  EXPECT_NEAR(compressible_packing({{1.0, 0.3, kBeta}, {1.0, 0.7, kBeta}}, 9.0), kBeta / (1.0 + 1.0 / 9.0), 1e-11);
  EXPECT_DOUBLE_EQ(loosening_effect(1.0, 1.0), 1.0);
  EXPECT_DOUBLE_EQ(wall_effect(1.0, 1.0), 1.0);
}

/// Furnas: infinitely fine grains fill the voids of coarse ones (gamma of coarse: beta_1/(1 - y_2)) or coarse grains
/// stand in a matrix of fines (gamma of fines: beta_2/(1 - (1 - beta_2) y_1)).
TEST(CompressiblePacking, ExtremeSizesAreThoseOfFurnas) {
  constexpr double kTiny = 1e-18;
  const double b1 = 0.72;
  const double b2 = 0.64;
  for (const double fines : {0.1, 0.3, 0.7}) {
    const auto gamma = virtual_fractions({{1.0, 1.0 - fines, b1}, {kTiny, fines, b2}});
    EXPECT_NEAR(gamma[0], b1 / (1.0 - fines), 1e-7) << fines;
    EXPECT_NEAR(gamma[1], b2 / (1.0 - (1.0 - b2) * (1.0 - fines)), 1e-7) << fines;
  }
  // Both are equal at the densest mixture, 1 - (1 - beta_1)(1 - beta_2), with fines of (1 - beta_1) beta_2.
  const double densest = 1.0 - (1.0 - b1) * (1.0 - b2);
  const double fines = (1.0 - b1) * b2 / densest;
  for (const double gamma : virtual_fractions({{1.0, 1.0 - fines, b1}, {kTiny, fines, b2}}))
    EXPECT_NEAR(gamma, densest, 1e-7);
}

/// Two sizes, by hand: d2/d1 = 1/8, K = 9, the implicit equation is a quadratic one in Phi.
TEST(CompressiblePacking, SolvesTheQuadraticOfTwoSizes) {
  const double y2 = 0.3;
  const double y1 = 1.0 - y2;
  const double a = std::sqrt(1.0 - std::pow(1.0 - 0.125, 1.02));
  const double b = 1.0 - std::pow(1.0 - 0.125, 1.5);
  const double g1 = kBeta / (1.0 - (1.0 - a) * y2);
  const double g2 = kBeta / (1.0 - (1.0 - kBeta + b * kBeta * (1.0 - 1.0 / kBeta)) * y1);
  const double index = 9.0;
  // With x = 1/Phi: K (x - 1/g1)(x - 1/g2) = y1/beta (x - 1/g2) + y2/beta (x - 1/g1).
  const double p = -index * (1.0 / g1 + 1.0 / g2) - 1.0 / kBeta;
  const double q = index / (g1 * g2) + y1 / (kBeta * g2) + y2 / (kBeta * g1);
  const double x = (-p + std::sqrt(p * p - 4.0 * index * q)) / (2.0 * index);
  EXPECT_NEAR(compressible_packing({{0.125, y2, kBeta}, {1.0, y1, kBeta}}, index), 1.0 / x, 1e-11);
}

TEST(CompressiblePacking, TendsToTheLeastVirtualFraction) {
  const std::vector<PackingClass> classes{{4.0, 0.5, kBeta}, {1.0, 0.3, kBeta}, {0.1, 0.2, kBeta}};
  const auto gamma = virtual_fractions(classes);
  EXPECT_NEAR(compressible_packing(classes, 1e9), *std::min_element(gamma.begin(), gamma.end()), 1e-6);
  EXPECT_LT(compressible_packing(classes, 4.1), compressible_packing(classes, 9.0));
}

TEST(CompressiblePacking, ClassesHoldTheWholeDistribution) {
  const Grading sizes = Grading::fuller(0.5, 1e-4, 1e-2);
  const auto classes = packing_classes(sizes, kBeta);
  ASSERT_EQ(classes.size(), 20U);
  double sum = 0.0;
  for (const PackingClass& c : classes) sum += c.share;
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_NEAR(classes.front().diameter, 2e-4 * std::pow(10.0, 0.05), 1e-12);
  EXPECT_NEAR(classes.front().share, sizes.passing(1e-4 * std::pow(10.0, 0.1)), 1e-12);
  EXPECT_EQ(packing_classes(Grading::list({0.5}), kBeta).size(), 1U);
}

TEST(CompressiblePacking, RefusesWhatIsNoMixture) {
  EXPECT_THROW((void)virtual_fractions({}), InputError);
  EXPECT_THROW((void)virtual_fractions({{1.0, 1.0, 1.0}}), InputError);
  EXPECT_THROW((void)virtual_fractions({{0.0, 1.0, 0.5}}), InputError);
  EXPECT_THROW((void)compressible_packing({{1.0, 1.0, 0.5}}, 0.0), InputError);
}

}  // namespace
}  // namespace softgrain
