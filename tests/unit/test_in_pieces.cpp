// Loops in pieces: the same bits for any number of threads, and errors that reach the caller.
#include "common/core/parallel_tasks.h"

#include <gtest/gtest.h>

#include <atomic>

#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "common/dynamics/residual.h"
#include "tests/support/small_packing.h"

namespace {

using namespace softgrain;

constexpr std::size_t kLength = 3 * kPieceLength + 17;

template <class Work>
auto with_threads(int threads, const Work& work) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  auto out = work();
  omp_set_num_threads(before);
  return out;
}

double sum_of_inverses(int threads) {
  return with_threads(threads, [] {
    return sum_in_pieces<double>(kLength, [](std::size_t begin, std::size_t end) {
      double sum = 0.0;
      for (std::size_t k = begin; k < end; ++k) sum += 1.0 / static_cast<double>(k + 1);
      return sum;
    });
  });
}

TEST(InPieces, SumsHaveTheSameBitsForAnyNumberOfThreads) {
  double plain = 0.0;
  for (std::size_t k = 0; k < kLength; ++k) plain += 1.0 / static_cast<double>(k + 1);
  const double one = sum_of_inverses(1);
  EXPECT_NEAR(one, plain, 1e-13 * plain);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(sum_of_inverses(threads), one) << threads;
}

TEST(InPieces, TheErrorOfTheFirstPieceIsThrown) {
  for (const int threads : {1, 3}) {
    const std::string said = with_threads(threads, [] {
      try {
        in_pieces(kLength, [](std::size_t begin, std::size_t) {
          if (begin > 0) throw std::out_of_range(std::to_string(begin));
        });
      } catch (const std::out_of_range& e) {
        return std::string(e.what());
      }
      return std::string("nothing");
    });
    EXPECT_EQ(said, std::to_string(kPieceLength)) << threads;
  }
}

TEST(WorstNetForce, LeavesOutTheShareThatIsFarthestFromRest) {
  System<3> s = test::hertz_system<3>(0.0, 1.0, false);
  for (int k = 0; k < 10; ++k) {
    add_grain(s.particles, test::test_sphere<3>(Vec3{{3.0 * k, 0.0, 0.0}}, 1.0, 2500.0));
    s.particles.force[static_cast<std::size_t>(k)] = Vec3{{0.0, (k * 7) % 10 + 1.0, 0.0}};
  }
  EXPECT_EQ(worst_net_force(s.particles), 10.0);
  EXPECT_EQ(worst_net_force(s.particles, 0.09), 10.0) << "rounded down";
  EXPECT_EQ(worst_net_force(s.particles, 0.1), 9.0);
  EXPECT_EQ(worst_net_force(s.particles, 0.35), 7.0);
  s.particles.force[3] = Vec3{{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}};
  EXPECT_FALSE(std::isfinite(worst_net_force(s.particles, 0.35))) << "what is no number is not left out";
}

/// Grains under a stress of 2 bear 8 pi r^2 in all, a sixth of which is their scale where it is above the mean force.
TEST(WorstNetForce, OfLargeBodiesIsComparedWithTheirOwnLoad) {
  System<3> s = test::hertz_system<3>(0.0, 1.0, false);
  for (const double r : {0.5, 1.0, 2.0, 4.0}) {
    add_grain(s.particles, test::test_sphere<3>(Vec3{{30.0 * r, 0.0, 0.0}}, r, 2500.0));
    s.particles.force.back() = Vec3{{0.0, 3.0 * r, 0.0}};
  }
  const ForceScale scale{5.0, 2.0};
  EXPECT_EQ(scale.of<3>(1.0), 5.0) << "4.19 is below the mean";
  EXPECT_NEAR(scale.of<3>(2.0), 8.0 * std::numbers::pi * 4.0 / 6.0, 1e-12);
  EXPECT_NEAR(scale.of<2>(4.0), 4.0 * std::numbers::pi * 4.0 / 6.0, 1e-12) << "a circumference bears it in the plane";
  // Over the scale: 1.5/5, 3/5, 6/16.8, 12/67.0.
  EXPECT_NEAR(worst_net_force(s.particles, scale, 0.0), 3.0, 1e-12);
  EXPECT_NEAR(worst_net_force(s.particles, scale, 0.25), 5.0 * 6.0 / scale.of<3>(2.0), 1e-12);
  EXPECT_NEAR(worst_net_force(s.particles, scale, 0.75), 5.0 * 12.0 / scale.of<3>(4.0), 1e-12);
  EXPECT_EQ(worst_net_force(s.particles, ForceScale{5.0, 0.0}, 0.0), 12.0);
  EXPECT_EQ(worst_net_force(s.particles, ForceScale{0.0, 2.0}, 0.0), 12.0) << "nothing presses yet";
}

/// A set of one sample must not keep its work on one thread.
TEST(ParallelTasks, ASingleTaskHasAllThreads) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(3);
  int inside_one = 0;
  parallel_tasks(1, [&](std::int64_t) {
#pragma omp parallel
#pragma omp single
    inside_one = omp_in_parallel() != 0 ? omp_get_num_threads() : 1;
  });
  std::atomic<int> in_parallel{0};
  parallel_tasks(3, [&](std::int64_t) { in_parallel += omp_in_parallel(); });
  omp_set_num_threads(before);
  EXPECT_EQ(inside_one, 3);
  EXPECT_EQ(in_parallel, 3) << "several tasks share the threads";
}

}  // namespace
