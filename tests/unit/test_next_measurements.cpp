// Which measurement narrows a prediction most: against the closed form of two numbers, against conditioning all at
// once, and against every order by brute force.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "calibrate/next_measurements.h"
#include "common/core/error.h"
#include "common/core/random.h"
#include "common/core/statistics.h"

namespace softgrain {
namespace {

/// Draws of three independent parameters; what is predicted depends on the first two.
struct Drawn {
  std::vector<std::vector<double>> predicted;
  std::vector<Measurable> measurables;

  explicit Drawn(int draws) {
    RandomStream random(5, RandomPurpose::test, 0);
    measurables = {{{}, 0.5, 1.0}, {{}, 0.5, 1.0}, {{}, 0.1, 1.0}, {{}, 0.5, 8.0}};
    for (int r = 0; r < draws; ++r) {
      const double a = random.normal();
      const double b = 0.3 * random.normal();
      const double idle = random.normal();
      predicted.push_back({2.0 * a + b, a});
      for (std::size_t k = 0; k < 4; ++k) measurables[k].drawn.push_back(std::array{a, b, idle, a}[k]);
    }
  }
};

double variance(const std::vector<double>& x) { return std::pow(mean_error(x).deviation, 2); }

std::vector<double> column(const std::vector<std::vector<double>>& rows, std::size_t k) {
  std::vector<double> out;
  for (const auto& row : rows) out.push_back(row[k]);
  return out;
}

/// var(q | y) = var(q) - cov(q, y)^2 / (var(y) + scatter^2 / n).
TEST(NextMeasurements, OneMeasurementNarrowsAsNormalVariablesDo) {
  const Drawn d(400);
  const NextMeasurements plan(d.predicted, d.measurables);
  const std::vector<double>& y = d.measurables[0].drawn;
  double before = 0.0;
  double after = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::vector<double> q = column(d.predicted, k);
    double product = 0.0;
    for (std::size_t r = 0; r < q.size(); ++r) product += (q[r] - mean_error(q).mean) * (y[r] - mean_error(y).mean);
    const double covariance = product / static_cast<double>(q.size() - 1);
    before += variance(q);
    after += variance(q) - covariance * covariance / (variance(y) + 0.25 / 7.0);
  }
  EXPECT_NEAR(plan.share_after(0, 7), std::sqrt(after / before), 1e-12);
  EXPECT_EQ(plan.share(), 1.0);
  EXPECT_GT(plan.share_after(2, 1000), 0.98) << "says nothing of what is predicted but by chance";
  EXPECT_LT(plan.share_after(0, 1000000), 0.2) << "only b is left open";
}

TEST(NextMeasurements, NoOrderOfMeasurementsMattersAndManyAreTheSumOfFew) {
  const Drawn d(60);
  NextMeasurements there(d.predicted, d.measurables);
  NextMeasurements back(d.predicted, d.measurables);
  NextMeasurements split(d.predicted, d.measurables);
  there.measure(0, 5), there.measure(1, 9);
  back.measure(1, 9), back.measure(0, 5);
  split.measure(0, 2), split.measure(1, 9), split.measure(0, 3);
  EXPECT_NEAR(there.share(), back.share(), 1e-12);
  EXPECT_NEAR(there.share(), split.share(), 1e-12);
  EXPECT_LT(there.share(), NextMeasurements(d.predicted, d.measurables).share_after(0, 5));
}

TEST(NextMeasurements, TheGreedyPlanTakesWhatNarrowsMostPerCost) {
  const Drawn d(200);
  const auto plan = plan_greedily(NextMeasurements(d.predicted, d.measurables), d.measurables, 4, 0.15, 100);
  ASSERT_FALSE(plan.empty());
  EXPECT_EQ(plan.front().measurable, 0U) << "a for 1, not a for 8";
  double before = 1.0;
  bool b_too = false;
  for (const PlannedBlock& block : plan) {
    EXPECT_NE(block.measurable, 3U);
    EXPECT_LT(block.share, before);
    EXPECT_EQ(block.cost, 4.0);
    before = block.share;
    b_too = b_too || block.measurable == 1U;
  }
  EXPECT_TRUE(b_too);
  EXPECT_LE(before, 0.15);
  EXPECT_EQ(plan_greedily(NextMeasurements(d.predicted, d.measurables), d.measurables, 4, 0.15, 1).size(), 1U);
}

TEST(NextMeasurements, WhatCannotBePlannedIsRefused) {
  const Drawn d(20);
  auto wrong = d.measurables;
  wrong[1].scatter = 0.0;
  EXPECT_THROW(NextMeasurements(d.predicted, wrong), InputError);
  wrong = d.measurables;
  wrong[2].drawn.pop_back();
  EXPECT_THROW(NextMeasurements(d.predicted, wrong), InputError);
  EXPECT_THROW(NextMeasurements({{1.0}, {2.0}}, {}), InputError);
  EXPECT_THROW(NextMeasurements({{1.0}, {1.0}, {1.0}}, {}), InputError) << "nothing to narrow";
}

}  // namespace
}  // namespace softgrain
