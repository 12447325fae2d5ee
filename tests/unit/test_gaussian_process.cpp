// Gaussian processes: a smooth function comes back within its band, leaving one out is what fits without it say, and
// the distance from a convex hull.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "calibrate/draws.h"
#include "calibrate/gaussian_process.h"
#include "common/core/error.h"
#include "common/core/parallel_tasks.h"
#include "common/core/random.h"
#include "common/core/statistics.h"

namespace softgrain {
namespace {

constexpr std::size_t kVariables = 4;
constexpr double kNoise = 0.05;

double smooth(const std::vector<double>& u) {
  return 2.0 * u[0] - u[1] + 0.8 * std::sin(2.0 * u[2]) + 0.5 * u[0] * u[3] + 0.3 * u[3] * u[3];
}

std::vector<double> point(RandomStream& random) {
  std::vector<double> u(kVariables);
  for (double& x : u) x = random.uniform();
  return u;
}

struct Sample {
  std::vector<std::vector<double>> points;
  std::vector<double> values;
  std::vector<double> errors;
};

Sample sample(std::size_t n, std::uint64_t seed, double noise = kNoise) {
  RandomStream random(seed, RandomPurpose::test, 0);
  Sample s;
  for (std::size_t k = 0; k < n; ++k) {
    s.points.push_back(point(random));
    s.values.push_back(smooth(s.points.back()) + noise * random.normal());
    s.errors.push_back(noise);
  }
  return s;
}

GaussianProcess process(const Sample& s) { return {s.points, s.values, s.errors}; }

TEST(GaussianProcess, ASmoothFunctionComesBackWithinItsBand) {
  int inside = 0;
  int all = 0;
  double squares = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const GaussianProcess g = process(sample(32, seed));
    RandomStream random(seed, RandomPurpose::test, 1);
    for (int k = 0; k < 50; ++k, ++all) {
      const std::vector<double> u = point(random);
      const ProcessValue z = g.at(u);
      const double off = z.mean - smooth(u);
      inside += std::abs(off) <= kNormal95 * z.deviation ? 1 : 0;
      squares += off * off;
    }
  }
  EXPECT_GE(inside, 0.88 * all);
  EXPECT_LT(std::sqrt(squares / all), 2.0 * kNoise) << "the function spreads by 0.7";
}

TEST(GaussianProcess, ALineIsExact) {
  Sample s = sample(12, 5, 0.0);
  for (std::size_t k = 0; k < s.points.size(); ++k) s.values[k] = 3.0 + s.points[k][0] - 2.0 * s.points[k][2];
  const ProcessValue z = process(s).at({0.2, 0.7, 0.4, 0.9});
  EXPECT_NEAR(z.mean, 3.0 + 0.2 - 0.8, 1e-3);
}

std::vector<ProcessValue> left_out(const Sample& s) { return leave_one_out(s.points, s.values, s.errors); }

Sample without(const Sample& all, std::size_t k) {
  Sample others = all;
  const auto at = static_cast<std::ptrdiff_t>(k);
  others.points.erase(others.points.begin() + at);
  others.values.erase(others.values.begin() + at);
  others.errors.erase(others.errors.begin() + at);
  return others;
}

TEST(GaussianProcess, LeavingOneOutIsThePredictionOfTheOthers) {
  const Sample all = sample(40, 7);
  const std::vector<ProcessValue> left = left_out(all);
  int inside = 0;
  for (std::size_t k = 0; k < all.values.size(); ++k) {
    inside +=
        std::abs(left[k].mean - all.values[k]) <= kNormal95 * std::hypot(left[k].deviation, all.errors[k]) ? 1 : 0;
    if (k % 10 != 0) continue;
    const ProcessValue z = process(without(all, k)).at(all.points[k]);
    EXPECT_EQ(z.mean, left[k].mean);
    EXPECT_EQ(z.deviation, left[k].deviation);
  }
  EXPECT_GE(inside, 35);
}

/// Without the one point that the first variable moves, nothing says that it does: the others predict their own mean,
/// with lengths of their own. Lengths of all points would know better.
TEST(GaussianProcess, TheOneLeftOutHasNoSayInTheLengths) {
  Sample s = sample(14, 3);
  for (std::size_t k = 0; k < s.points.size(); ++k) {
    s.points[k][0] = k == 0 ? 1.0 : 0.0;
    s.values[k] = (k == 0 ? 5.0 : 0.0) + 0.1 * std::sin(7.0 * static_cast<double>(k));
  }
  const std::vector<ProcessValue> left = left_out(s);
  s.values[0] = -40.0;
  EXPECT_EQ(left_out(s)[0].mean, left[0].mean) << "whatever its value";
  EXPECT_EQ(left_out(s)[0].deviation, left[0].deviation);
}

TEST(GaussianProcess, LeavingOneOutIsTheSameForAnyNumberOfThreads) {
  const Sample all = sample(16, 11);
  const std::vector<ProcessValue> many = left_out(all);
  const OneThread one;
  const std::vector<ProcessValue> alone = left_out(all);
  for (std::size_t k = 0; k < many.size(); ++k) EXPECT_EQ(many[k].mean, alone[k].mean) << k;
}

TEST(GaussianProcess, ScatterOfThePointsIsInTheBand) {
  Sample s = sample(40, 9, 0.3);
  s.errors.assign(s.errors.size(), 0.0);
  EXPECT_NEAR(process(s).scatter(), 0.3, 0.12);
}

TEST(GaussianProcess, RefusesWhatDoesNotGoTogether) {
  Sample s = sample(6, 1);
  EXPECT_THROW((void)process(s), InputError) << "fewer than its trend needs";
  s = sample(12, 1);
  s.errors.pop_back();
  EXPECT_THROW((void)process(s), InputError);
  s = sample(12, 1);
  s.values[3] = std::nan("");
  EXPECT_THROW((void)process(s), InputError);
  EXPECT_THROW((void)left_out(sample(7, 1)), InputError) << "six are too few";
}

TEST(GaussianProcess, RefusesACovarianceWithoutCholeskyDecomposition) {
  for (const double far : {1e10, 1e170}) {
    Sample s = sample(12, 1);
    for (std::vector<double>& u : s.points)
      for (double& x : u) x *= far;
    EXPECT_THROW((void)process(s), InputError) << far;
  }
}

TEST(DistanceFromHull, OfASquareAndItsInside) {
  const std::vector<std::vector<double>> square{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}, {0.5, 0.6}};
  EXPECT_NEAR(distance_from_hull(square, {0.3, 0.9}), 0.0, 1e-4);
  EXPECT_NEAR(distance_from_hull(square, {0.5, 1.25}), 0.25, 1e-3);
  EXPECT_NEAR(distance_from_hull(square, {2.0, 2.0}), std::sqrt(2.0), 1e-2);
  const std::vector<std::vector<double>> triangle{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
  EXPECT_NEAR(distance_from_hull(triangle, {1.0, 1.0}), std::sqrt(0.5), 1e-2);
}

/// Two numbers that go together, of which one is measured: closed form.
TEST(UpdatedNumbers, WhatIsNotMeasuredFollowsByTheCovariance) {
  const NormalNumbers before{{1.0, 2.0}, {4.0, 3.0, 3.0, 9.0}};
  const double none = std::numeric_limits<double>::quiet_NaN();
  const NormalNumbers after = updated(before, {0}, {{3.0, none}, {1.0, none, none, none}});
  EXPECT_NEAR(after.mean[0], 1.0 + 4.0 / 5.0 * 2.0, 1e-12);
  EXPECT_NEAR(after.mean[1], 2.0 + 3.0 / 5.0 * 2.0, 1e-12);
  EXPECT_NEAR(after.covariance[0], 4.0 - 16.0 / 5.0, 1e-12);
  EXPECT_NEAR(after.covariance[1], 3.0 - 12.0 / 5.0, 1e-12);
  EXPECT_NEAR(after.covariance[3], 9.0 - 9.0 / 5.0, 1e-12);
}

}  // namespace
}  // namespace softgrain
