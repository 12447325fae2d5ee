// Largest and smallest values of noisy results: optima of quadratic surfaces, their intervals, where to look next.
#include <gtest/gtest.h>

#include <cmath>

#include "calibrate/optimum_search.h"
#include "common/core/error.h"
#include "common/core/random.h"

namespace softgrain {
namespace {

using Points = std::vector<std::vector<double>>;

template <class Function>
ResponseSurface through(const Points& points, const Function& f) {
  Points values;
  for (const auto& u : points) values.push_back({f(u)});
  return {points, values, std::vector<double>(points.size(), 1.0)};
}

TEST(OptimumOfASurface, IsTheTopOfAParabolaOrAnEnd) {
  const Points points = first_search_points(1);
  const auto top = through(points, [](const auto& u) { return 2.0 - 3.0 * (u[0] - 0.3) * (u[0] - 0.3); });
  EXPECT_NEAR(optimum_of(top, true).u[0], 0.3, 1e-4);
  EXPECT_NEAR(optimum_of(top, true).value, 2.0, 1e-4);
  EXPECT_DOUBLE_EQ(optimum_of(top, false).u[0], 1.0);  // the farther end
  const auto line = through(points, [](const auto& u) { return 5.0 * u[0]; });
  EXPECT_DOUBLE_EQ(optimum_of(line, true).u[0], 1.0);
  EXPECT_DOUBLE_EQ(optimum_of(line, false).u[0], 0.0);
}

TEST(OptimumOfASurface, OfTwoInputsIsInsideOnAnEdgeOrAtACorner) {
  const Points points = first_search_points(2);
  const auto inside = through(points, [](const auto& u) {
    return -std::pow(u[0] - 0.4, 2) - 2.0 * std::pow(u[1] - 0.7, 2) + 0.5 * (u[0] - 0.4) * (u[1] - 0.7);
  });
  EXPECT_NEAR(optimum_of(inside, true).u[0], 0.4, 1e-3);
  EXPECT_NEAR(optimum_of(inside, true).u[1], 0.7, 1e-3);
  const auto edge = through(points, [](const auto& u) { return -std::pow(u[0] - 0.25, 2) - std::pow(u[1] - 1.5, 2); });
  EXPECT_NEAR(optimum_of(edge, true).u[0], 0.25, 1e-3);
  EXPECT_DOUBLE_EQ(optimum_of(edge, true).u[1], 1.0);
  EXPECT_EQ(optimum_of(edge, false).u, (std::vector<double>{1.0, 0.0}));
  // A saddle has its best at an end, not at the stationary point.
  const auto saddle = through(points, [](const auto& u) { return std::pow(u[0] - 0.4, 2) - std::pow(u[1] - 0.5, 2); });
  EXPECT_DOUBLE_EQ(optimum_of(saddle, true).u[0], 1.0);
  EXPECT_NEAR(optimum_of(saddle, true).u[1], 0.5, 1e-3);
}

/// Noise that all points of a seed share moves the values, not the optimum.
TEST(FindOptimum, WhatSeedsHaveInCommonCancels) {
  SearchedPoints data;
  data.points = first_search_points(1);
  const std::vector<double> offsets{0.5, -0.3, 0.8, -0.9};
  for (const auto& u : data.points) {
    data.values.emplace_back();
    for (const double offset : offsets) data.values.back().push_back(1.0 - std::pow(u[0] - 0.6, 2) + offset);
  }
  const OptimumEstimate best = find_optimum(data, true, 1);
  ASSERT_TRUE(best.usable) << best.message;
  EXPECT_TRUE(best.over_seeds);
  EXPECT_NEAR(best.u[0].value, 0.6, 1e-3);
  EXPECT_NEAR(best.u[0].low, 0.6, 1e-3);
  EXPECT_NEAR(best.u[0].high, 0.6, 1e-3);
  EXPECT_GT(best.value.high - best.value.low, 0.5);
  EXPECT_NEAR(best.inside, 1.0, 1e-9);
}

/// Independent noise: the interval holds the truth about as often as it says.
TEST(FindOptimum, IntervalsOfScatterHoldTheTruth) {
  constexpr int kTrials = 60;
  int held = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    RandomStream random(7, RandomPurpose::test, static_cast<std::uint64_t>(trial));
    SearchedPoints data;
    for (int k = 0; k <= 8; ++k) {
      const double u = k / 8.0;
      data.points.push_back({u});
      data.values.push_back({-std::pow(u - 0.45, 2) + 0.01 * random.normal()});
    }
    const OptimumEstimate best = find_optimum(data, true, 1);
    ASSERT_TRUE(best.usable);
    EXPECT_FALSE(best.over_seeds);
    held += best.u[0].low <= 0.45 && 0.45 <= best.u[0].high ? 1 : 0;
  }
  EXPECT_GE(held, kTrials * 85 / 100);
}

/// Root mean square error of the place of the top of a noisy parabola after a search of so many points.
double error_of_search(std::size_t points, double noise) {
  constexpr int kTrials = 40;
  double sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    RandomStream random(11, RandomPurpose::test, static_cast<std::uint64_t>(trial));
    SearchedPoints data;
    const auto add = [&](const Points& more) {
      for (const auto& u : more) {
        if (data.points.size() >= points) return;
        data.points.push_back(u);
        data.values.push_back({-std::pow(u[0] - 0.63, 2) + noise * random.normal()});
      }
    };
    add(first_search_points(1));
    for (int round = 1; round <= 8 && data.points.size() < points; ++round)
      add(next_search_points({find_optimum(data, true, 1).u[0].value}, data.points, round));
    sum += std::pow(find_optimum(data, true, 1).u[0].value - 0.63, 2) / kTrials;
  }
  return std::sqrt(sum);
}

/// Later rounds lie close together, where noise hides the top: they must not outweigh the first ones.
TEST(FindOptimum, MorePointsDoNotMislead) {
  EXPECT_LT(error_of_search(9, 0.004), 0.02);
  EXPECT_LT(error_of_search(20, 0.004), 0.02);
  EXPECT_LT(error_of_search(20, 0.012), 0.05);
}

TEST(FindOptimum, SaysWhatItCannotTell) {
  SearchedPoints few{{{0.0}, {1.0}}, {{1.0}, {2.0}}};
  EXPECT_FALSE(find_optimum(few, true, 1).usable);
  EXPECT_FALSE(find_optimum({}, true, 1).usable);
  // As many points as coefficients: a place, without an interval.
  SearchedPoints exact{{{0.0}, {0.5}, {1.0}}, {{0.0}, {1.0}, {0.0}}};
  const OptimumEstimate best = find_optimum(exact, true, 1);
  EXPECT_NEAR(best.u[0].value, 0.5, 1e-6);
  EXPECT_DOUBLE_EQ(best.u[0].low, 0.0);
  EXPECT_DOUBLE_EQ(best.u[0].high, 1.0);
}

TEST(SearchPoints, HalveTheirStepsAndLeaveOutWhatIsThere) {
  const Points first = first_search_points(1);
  EXPECT_EQ(next_search_points({0.5}, first, 1), (Points{{0.375}, {0.625}}));
  EXPECT_EQ(next_search_points({1.0}, first, 1), (Points{{0.875}}));
  EXPECT_EQ(first_search_points(2).size(), 9U);
  EXPECT_EQ(next_search_points({0.4, 0.6}, first_search_points(2), 1).size(), 5U);
}

}  // namespace
}  // namespace softgrain
