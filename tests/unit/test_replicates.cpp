// The loop of bootstraps: which random numbers a replicate gets, and how a signal ends it.
#include "calibrate/draws.h"

#include <gtest/gtest.h>

#include "common/core/error.h"

namespace softgrain {
namespace {

double two_draws(RandomStream& random) {
  const double first = random.uniform();
  return first + 2.0 * random.uniform();
}

TEST(Replicates, ReplicateRHasTheRandomNumbersOfPlaceFirstPlusR) {
  constexpr std::uint64_t kSeed = 7;
  constexpr std::uint64_t kFirst = std::uint64_t{3} << 32U;
  const std::vector<double> all = bootstrap_replicates(50, kSeed, kFirst, "testing", two_draws);
  ASSERT_EQ(all.size(), 50U);
  for (std::size_t r = 0; r < all.size(); ++r) {
    RandomStream random(kSeed, RandomPurpose::bootstrap, kFirst + r);
    EXPECT_EQ(all[r], two_draws(random)) << r;
  }
  EXPECT_TRUE(bootstrap_replicates(0, kSeed, kFirst, "testing", two_draws).empty());
}

TEST(Replicates, ASignalEndsTheLoop) {
  request_interrupt();
  EXPECT_THROW((void)bootstrap_replicates(5, 1, 0, "testing", two_draws), Interrupted);
  clear_interrupt();
}

}  // namespace
}  // namespace softgrain
