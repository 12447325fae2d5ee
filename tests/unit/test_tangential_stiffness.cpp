// kt from forces under rotation, on curves whose slope is known.
#include "calibrate/curve_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace {

using namespace softgrain;

constexpr double kShell = 0.016;

/// F = F0 + k ht for |angle| <= 0.05 degree, bending to half the slope beyond: prestrain and a kink, as measured curves
/// have.
std::vector<TangentialPoint> curve(double prestrain, double k, const std::vector<double>& angles) {
  std::vector<TangentialPoint> out;
  for (const double angle : angles) {
    const double ht = std::numbers::pi * kShell * angle / 180.0;
    const double bend = std::numbers::pi * kShell * 0.05 / 180.0;
    const double beyond = std::max(std::abs(ht) - bend, 0.0);
    const double force = prestrain + k * std::copysign(std::min(std::abs(ht), bend) + 0.5 * beyond, ht);
    out.push_back({0.2, angle, force, 0.0, 0.0, true});
  }
  return out;
}

TEST(TangentialStiffness, DisplacementOfOneDegree) {
  EXPECT_DOUBLE_EQ(tangential_displacement(180.0, kShell), std::numbers::pi * kShell);
}

TEST(TangentialStiffness, PrestrainDropsOutOfTheInitialSlope) {
  const auto points = curve(0.4, 250.0, {-1.0, -0.05, -0.02, 0.0, 0.02, 0.05, 1.0});
  EXPECT_NEAR(initial_slope(points, 0.05, kShell).value(), 250.0, 1e-9);
}

TEST(TangentialStiffness, OneSignIsEnough) {
  const auto points = curve(0.4, 250.0, {0.0, 0.025, 0.05, 1.0});
  EXPECT_NEAR(initial_slope(points, 0.05, kShell).value(), 250.0, 1e-9);
  EXPECT_NEAR(secant(points, 1.0, kShell).value(), 250.0 * (0.05 + 0.5 * 0.95), 1e-9);
}

TEST(TangentialStiffness, SecantUsesBothSigns) {
  const auto points = curve(0.4, 250.0, {-1.0, 0.0, 1.0});
  EXPECT_NEAR(secant(points, 1.0, kShell).value(), 250.0 * (0.05 + 0.5 * 0.95), 1e-9);
}

TEST(TangentialStiffness, RoundingOfTheAngleDoesNotLoseAPoint) {
  const auto points = curve(0.0, 250.0, {-0.05 - 1e-9, 0.0, 0.05 + 1e-9, 1.0 - 1e-9, -1.0});
  EXPECT_NEAR(initial_slope(points, 0.05, kShell).value(), 250.0, 1e-3);
  EXPECT_TRUE(secant(points, 1.0, kShell).has_value());
}

TEST(TangentialStiffness, UnconvergedPointsAreNotUsed) {
  auto points = curve(0.4, 250.0, {-1.0, -0.05, 0.0, 0.05, 1.0});
  points[1].force_parallel = 1e6;
  points[1].converged = false;
  EXPECT_NEAR(initial_slope(points, 0.05, kShell).value(), 250.0, 1e-9);
  points[0].converged = false;
  EXPECT_NEAR(secant(points, 1.0, kShell).value(), 250.0 * 0.525, 1e-9);
  points[4].converged = false;
  EXPECT_FALSE(secant(points, 1.0, kShell).has_value());
}

TEST(TangentialStiffness, NoSlopeFromOneAngle) {
  EXPECT_FALSE(initial_slope(curve(0.4, 250.0, {0.0, 1.0}), 0.05, kShell).has_value());
  EXPECT_FALSE(initial_slope(curve(0.4, 250.0, {0.0, 0.0}), 0.05, kShell).has_value());
  EXPECT_FALSE(initial_slope({}, 0.05, kShell).has_value());
}

}  // namespace
