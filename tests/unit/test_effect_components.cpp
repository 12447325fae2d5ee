// Combinations of parameters that change what a law says, and draws from a covariance.
#include <gtest/gtest.h>

#include <cmath>

#include "calibrate/draws.h"
#include "common/core/error.h"
#include "common/core/random.h"
#include "common/core/statistics.h"

namespace softgrain {
namespace {

/// Two parameters that nearly cancel: only their sum matters.
TEST(EffectComponents, FindWhatMattersAmongParametersThatCancel) {
  std::vector<std::vector<double>> parameters;
  std::vector<std::vector<double>> effects;
  RandomStream random(1, RandomPurpose::test, 0);
  for (int r = 0; r < 200; ++r) {
    const double sum = 0.1 * random.normal();
    const double idle = 3.0 * random.normal();
    parameters.push_back({0.5 * sum + idle, 0.5 * sum - idle, 7.0});
    effects.push_back({sum, 2.0 * sum, -sum});
  }
  const EffectComponents c = effect_components(parameters, effects, 4, 0.95);
  ASSERT_EQ(c.direction.size(), 1U);
  EXPECT_NEAR(c.explained, 1.0, 1e-12);
  EXPECT_NEAR(std::abs(c.direction[0][0] + c.direction[0][1]), 0.1, 0.02);
  EXPECT_EQ(c.direction[0][2], 0.0) << "what never differs stays";
  std::vector<double> scores;
  for (const auto& s : c.scores) scores.push_back(s[0]);
  EXPECT_NEAR(mean_error(scores).mean, 0.0, 1e-9);
  EXPECT_NEAR(mean_error(scores).deviation, 1.0, 1e-9);
}

TEST(EffectComponents, KeepWhatHoldsTheShareAndNoMoreThanAllowed) {
  std::vector<std::vector<double>> parameters;
  RandomStream random(2, RandomPurpose::test, 0);
  for (int r = 0; r < 400; ++r) parameters.push_back({random.normal(), 0.5 * random.normal(), 0.1 * random.normal()});
  const auto kept = [&](std::size_t most, double share) {
    return effect_components(parameters, parameters, most, share).direction.size();
  };
  EXPECT_EQ(kept(4, 0.5), 1U);
  EXPECT_EQ(kept(4, 0.95), 2U);
  EXPECT_EQ(kept(4, 1.0), 3U);
  EXPECT_EQ(kept(2, 1.0), 2U);
  EXPECT_THROW((void)effect_components({{1.0}, {2.0}}, {{1.0}, {2.0}}, 1, 0.9), InputError);
}

TEST(EffectComponents, NormalDrawsHaveTheirCovariance) {
  const std::vector<double> covariance{4.0, 1.2, 0.0, 1.2, 1.0, 0.0, 0.0, 0.0, 0.0};
  const auto draws = normal_draws({1.0, -2.0, 5.0}, covariance, 4000, 3);
  std::vector<double> a;
  std::vector<double> b;
  double product = 0.0;
  for (const auto& d : draws) {
    a.push_back(d[0]);
    b.push_back(d[1]);
    product += (d[0] - 1.0) * (d[1] + 2.0) / 4000.0;
    EXPECT_EQ(d[2], 5.0);
  }
  EXPECT_NEAR(mean_error(a).mean, 1.0, 0.1);
  EXPECT_NEAR(mean_error(a).deviation, 2.0, 0.08);
  EXPECT_NEAR(mean_error(b).deviation, 1.0, 0.04);
  EXPECT_NEAR(product, 1.2, 0.12);
  EXPECT_THROW((void)normal_draws({0.0, 0.0}, {1.0, 2.0, 2.0, 1.0}, 2, 1), InputError);
  EXPECT_THROW((void)normal_draws({0.0}, {HUGE_VAL}, 2, 1), InputError);
}

}  // namespace
}  // namespace softgrain
