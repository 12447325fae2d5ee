// Random numbers stay within what they promise.
#include "common/core/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace softgrain;

TEST(RandomStream, UniformNumbersAreAboveZeroAndBelowOne) {
  EXPECT_EQ(RandomStream::open_unit(0), 0x1p-54);
  EXPECT_LT(RandomStream::open_unit(UINT64_MAX), 1.0);
  EXPECT_GT(RandomStream::open_unit(UINT64_MAX), 1.0 - 0x1p-52);
  double last = 0.0;
  for (const std::uint64_t k : {0ULL, 1ULL, 2ULL, (1ULL << 52) - 1, 1ULL << 52, (1ULL << 53) - 2}) {
    const double u = RandomStream::open_unit(k << 11);
    EXPECT_EQ(u, (static_cast<double>(k) + 0.5) * 0x1p-53) << k;
    EXPECT_GT(u, last) << k;
    last = u;
  }
}

/// Numbers of seeds in use must never change.
TEST(RandomStream, GivesTheNumbersThatItHasAlwaysGiven) {
  RandomStream random(1, RandomPurpose::test, 0);
  const double first = random.uniform();
  EXPECT_EQ(first, 0x1.204adea3ff12p-1);
  double sum = first;
  for (int k = 1; k < 1000; ++k) sum += random.uniform();
  EXPECT_NEAR(sum, 500.0, 4.0 * std::sqrt(1000.0 / 12.0));
}

}  // namespace
