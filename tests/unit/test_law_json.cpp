// Laws in a summary: units, intervals, and nulls where nothing is known.
#include "pipelines/law/law_json.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace {

using namespace softgrain;

PairLaw example() {
  PairLaw law;
  law.status = LawStatus::good;
  law.normal.a = {0.5755, 0.01, 0.55, 0.60};
  law.normal.b = {2.8, 0.03, 2.7, 2.9};
  law.normal.c = {-0.0003, 1e-5, -0.0004, -0.0002};
  law.normal.delta = {0.065, 0.001, 0.063, 0.067};
  law.tangential_initial = law.normal;
  law.tangential_initial.a.value = 2.0;
  law.has_tangential_initial = true;
  law.packings = 32;
  return law;
}

TEST(LawJson, UnitsAreNewtonsAndNewtonsPerMetreAndPerDegree) {
  LawCard card;
  card.pairs.push_back(example());
  const auto j = json_of(summary_of(card))["soft-solid"];
  EXPECT_NEAR(j["normal"]["a"].get<double>(), 0.5755 * 128.0, 1e-12);  // E Rs^2 = 128 N
  EXPECT_NEAR(j["normal"]["a_interval"][1].get<double>(), 0.60 * 128.0, 1e-12);
  EXPECT_NEAR(j["normal"]["c"].get<double>(), -0.0003 * 128.0, 1e-12);
  EXPECT_EQ(j["normal"]["b"], 2.8);
  EXPECT_EQ(j["normal"]["delta_interval"][0], 0.063);
  EXPECT_NEAR(j["tangential"]["a"].get<double>(), 2.0 * 8000.0, 1e-9);  // E Rs = 8000 N/m
  EXPECT_NEAR(j["tangential"]["a_per_degree"].get<double>(), 16000.0 * std::numbers::pi * 0.016 / 180.0, 1e-9);
  EXPECT_EQ(j["dimensionless"]["normal"]["a"], 0.5755);
  EXPECT_TRUE(j["tangential_secant"].is_null());
  EXPECT_EQ(j["packings"], 32);
}

TEST(LawJson, UnknownIsNullAndStaysValidJson) {
  LawCard card;
  PairLaw law = example();
  law.kind = PairKind::soft_soft;
  law.status = LawStatus::underdetermined;
  law.reason = "1 packing, 5 needed for an interval.";
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  law.normal.a = {0.5755, kInfinity, -kInfinity, kInfinity};
  card.pairs.push_back(law);
  const auto j = nlohmann::json::parse(json_of(summary_of(card)).dump())["soft-soft"];
  EXPECT_TRUE(j["normal"]["a_standard_error"].is_null());
  EXPECT_TRUE(j["normal"]["a_interval"][0].is_null());
  EXPECT_FALSE(j["normal"]["a"].is_null());
  EXPECT_EQ(j["reason"], law.reason);
}

TEST(LawJson, NoCrossingHasNoLaw) {
  LawCard card;
  PairLaw law;
  law.status = LawStatus::no_threshold_crossing;
  card.pairs.push_back(law);
  const auto j = json_of(summary_of(card))["soft-solid"];
  EXPECT_EQ(j["status"], "no threshold crossing");
  EXPECT_TRUE(j["normal"].is_null());
}

TEST(LawJson, EmptyCardIsAnEmptyObject) { EXPECT_TRUE(json_of(summary_of(LawCard{})).is_object()); }

}  // namespace
