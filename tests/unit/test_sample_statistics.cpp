// Means over samples: nested numbers, undefined ones, one sample, none.
#include "pipelines/kinds/cohesive_powder/summary.h"

#include <gtest/gtest.h>

#include <cmath>

namespace softgrain {
namespace {

using nlohmann::json;

TEST(SampleStatistics, MeanAndDeviationOfEveryNumber) {
  const json s = sample_statistics({{{"a", 1.0}, {"in", {{"b", 3}, {"flag", true}}}, {"list", {1, 2}}, {"text", "x"}},
                                    {{"a", 2.0}, {"in", {{"b", nullptr}}}},
                                    {{"a", 6.0}, {"in", nullptr}}});
  EXPECT_NEAR(s["a"]["mean"].get<double>(), 3.0, 1e-15);
  EXPECT_NEAR(s["a"]["deviation"].get<double>(), std::sqrt((4.0 + 1.0 + 9.0) / 2.0), 1e-15);
  EXPECT_EQ(s["a"]["samples"], 3);
  EXPECT_EQ(s["in.b"]["mean"], 3.0);
  EXPECT_EQ(s["in.b"]["samples"], 1) << "null does not count";
  EXPECT_TRUE(s["in.b"]["deviation"].is_null());
  EXPECT_FALSE(s.contains("list"));
  EXPECT_FALSE(s.contains("text"));
  EXPECT_FALSE(s.contains("in.flag"));
  EXPECT_TRUE(s["in"]["mean"].is_null());
  EXPECT_TRUE(sample_statistics({}).empty());
}

TEST(SampleStatistics, SmallDifferencesOfLargeNumbersSurvive) {
  const json s = sample_statistics({{{"a", 1e9 + 1.0}}, {{"a", 1e9 - 1.0}}});
  EXPECT_NEAR(s["a"]["deviation"].get<double>(), std::sqrt(2.0), 1e-9);
}

}  // namespace
}  // namespace softgrain
