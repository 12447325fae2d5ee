// The interval that replicates of a bootstrap give.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>

#include "calibrate/bootstrap.h"

namespace softgrain {
namespace {

std::vector<double> counted(std::size_t n) {
  std::vector<double> values(n);
  std::iota(values.rbegin(), values.rend(), 1.0);  // 1 to n, the largest first
  return values;
}

/// Between x_1 and x_2 of 40, so that one more value would be inside with 95 % and not with 90 %.
TEST(Interval95, HoldsItsShareWithFewReplicatesToo) {
  const auto [low, high] = interval95(counted(40));
  EXPECT_NEAR(low, 1.025, 1e-12);
  EXPECT_NEAR(high, 39.975, 1e-12);
  EXPECT_NEAR(interval95(counted(999)).first, 25.0, 1e-12);
  EXPECT_NEAR(interval95(counted(999)).second, 975.0, 1e-12);
}

TEST(Interval95, FewValuesGiveTheirExtremesAndNoneNothing) {
  EXPECT_EQ(interval95(counted(5)), std::make_pair(1.0, 5.0));
  EXPECT_EQ(interval95({}).second, HUGE_VAL);
}

/// Of a sample: sum (x - mean)(y - mean)/(n - 1).
TEST(ReplicateCovariance, IsThatOfASample) {
  std::vector<std::array<double, 7>> replicates(3);
  const double x[] = {1.0, 2.0, 6.0};
  const double y[] = {4.0, 1.0, 1.0};
  for (std::size_t r = 0; r < 3; ++r) {
    replicates[r][2] = x[r];
    replicates[r][5] = y[r];
  }
  const std::vector<double> c = replicate_covariance(replicates);
  ASSERT_EQ(c.size(), 49U);
  EXPECT_NEAR(c[2 * 7 + 2], 7.0, 1e-12);
  EXPECT_NEAR(c[5 * 7 + 5], 3.0, 1e-12);
  EXPECT_NEAR(c[2 * 7 + 5], -3.0, 1e-12);
  EXPECT_NEAR(c[5 * 7 + 2], -3.0, 1e-12);
  EXPECT_EQ(c[0], 0.0);
  replicates.resize(1);
  EXPECT_EQ(replicate_covariance(replicates), std::vector<double>(49, 0.0));
}

}  // namespace
}  // namespace softgrain
