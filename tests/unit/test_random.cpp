// Random numbers stay within what they promise.
#include "common/core/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <regex>
#include <string>

#include "common/io/text_file.h"

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

/// Every purpose in the sources has a number of its own.
TEST(RandomStream, PurposesDiffer) {
  namespace fs = std::filesystem;
  std::map<std::string, std::string> holder{{"1", ""}, {"2", ""}, {"3", ""}, {"6", ""}, {"7", ""}, {"8", ""}};
  const std::size_t shared = holder.size();
  const std::regex declared(R"(RandomPurpose (k\w+)\{(\d+)\})");
  for (const char* layer : {"common", "microsim", "calibrate", "macrosim", "pipelines"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(SOFTGRAIN_SOURCE_DIR) / layer)) {
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
      const std::string text = read_text(entry.path().string());
      for (std::sregex_iterator at(text.begin(), text.end(), declared), end; at != end; ++at)
        EXPECT_TRUE(holder.emplace((*at)[2], (*at)[1]).second) << entry.path() << ": " << (*at)[0];
    }
  EXPECT_GE(holder.size() - shared, 8U);
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
