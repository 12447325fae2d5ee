#include "common/dynamics/thread_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "common/neighbours/spatial_order.h"

namespace softgrain {
namespace {

TEST(ThreadPace, SharesFollowPairsPerSecond) {
  ThreadPace pace;
  pace.share_out(3);
  EXPECT_EQ(pace.share, (std::vector<double>(3, 1.0 / 3.0)));
  pace.seconds = {1.0, 2.0, 1.0};
  pace.passes = 100;
  EXPECT_TRUE(pace.uneven());
  pace.share_out(3);
  EXPECT_NEAR(pace.share[0], 0.4, 1e-12);
  EXPECT_NEAR(pace.share[1], 0.2, 1e-12);
  EXPECT_NEAR(pace.share[2], 0.4, 1e-12);
  EXPECT_EQ(pace.passes, 0);
  // With these shares all take equally long: nothing changes any more.
  pace.seconds = {1.2, 1.2, 1.2};
  pace.passes = 200;
  EXPECT_FALSE(pace.uneven());
  pace.share_out(3);
  EXPECT_NEAR(pace.share[1], 0.2, 1e-12);
}

TEST(ThreadPace, AThreadThatStallsKeepsSomething) {
  ThreadPace pace;
  pace.share_out(2);
  pace.seconds = {1.0, 1000.0};
  pace.passes = 100;
  pace.share_out(2);
  EXPECT_NEAR(pace.share[1], 0.1 / (0.1 + 1000.0 / 1001.0), 1e-12);
  EXPECT_NEAR(pace.share[0] + pace.share[1], 1.0, 1e-15);
}

TEST(ThreadPace, LooksEverLessOften) {
  ThreadPace pace;
  pace.share_out(2);
  int after = 0;
  for (int k = 0; k < 8; ++k) {
    while (!pace.uneven()) {
      ++pace.passes;
      pace.seconds = {1.0, k % 2 == 0 ? 2.0 : 0.5};  // a machine that cannot make up its mind
    }
    EXPECT_GE(pace.passes, after);
    after = pace.passes;
    pace.share_out(2);
  }
  EXPECT_EQ(after, 1024);
}

TEST(ThreadPace, TooLittleToGoByLeavesTheShares) {
  ThreadPace pace;
  pace.share_out(2);
  pace.seconds = {1.0, 3.0};
  pace.passes = 3;
  EXPECT_FALSE(pace.uneven());
  pace.share_out(2);
  EXPECT_EQ(pace.share[0], 0.5);
  pace.share_out(4);  // another number of threads
  EXPECT_EQ(pace.share, std::vector<double>(4, 0.25));
}

/// Neighbours on the curve are neighbours in space, whatever the sizes: a stretch holds grains of all classes.
TEST(CurveParts, AreThePlacesOfTheCurve) {
  System<3> s;
  s.cell.edges = {};
  for (int k = 0; k < 3; ++k) {
    s.cell.edges[k][k] = 8.0;
    s.cell.periodic[static_cast<std::size_t>(k)] = true;
  }
  for (int k = 0; k < 8; ++k) {
    const double at = 0.25 + k;
    add_grain(s.particles, NewBody<3>{.x = {{at, at, at}}, .r = k % 2 == 0 ? 0.2 : 0.01, .mass = 1.0, .inertia = 1.0});
  }
  const std::vector<std::uint16_t> part = curve_parts(s);
  ASSERT_EQ(part.size(), 8U);
  EXPECT_TRUE(std::is_sorted(part.begin(), part.end()));
  // A half of every edge is an eighth of the curve, the first or the last here.
  EXPECT_LT(part[3], kCurveParts / 8);
  EXPECT_GE(part[4], kCurveParts - kCurveParts / 8);
}

}  // namespace
}  // namespace softgrain
