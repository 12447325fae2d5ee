// A constant force without contact: found, taken off, said; and said to be open where too few readings tell.

#include <gtest/gtest.h>

#include <cmath>

#include "calibrate/experiment_fit.h"
#include "common/data/law_band.h"
#include "tests/support/synthetic_law.h"

namespace {

using namespace softgrain;
using test::KnownLaw;
using test::normal_number;

constexpr double kUnit = 128.0;  // E Rs^2 [N] of the default soft particle

struct Pressed {
  double offset = 0.0;  ///< [N]
  double noise = 0.002;
  int points = 30;
  double first = 0.01;  ///< smallest Delta
  int before = 0;       ///< readings before touch
  std::uint64_t seed = 3;
};

ForceCurves pressed(const Pressed& p) {
  RandomStream random(p.seed, RandomPurpose::test, 0);
  ForceCurves out;
  ForceCurve curve{"A", {}, {}, {}};
  const auto read = [&](double delta) {
    return kUnit * KnownLaw{}.value(delta) + p.offset + p.noise * normal_number(random);
  };
  for (int k = 0; k < p.before; ++k) curve.before_touch.push_back(read(0.0));
  for (int k = 0; k < p.points; ++k) {
    const double d = p.first + (0.3 - p.first) * k / (p.points - 1);
    curve.normal.push_back({d, read(d), std::nan("")});
  }
  out.samples.push_back(std::move(curve));
  return out;
}

ExperimentFit fitted(const Pressed& p, bool subtract = true) {
  FitOptions options;
  options.replicates = 100;
  options.subtract_offset = subtract;
  return fit_experiment({pressed(p)}, options, false);
}

bool says(const ExperimentFit& fit, const std::string& words) {
  for (const std::string& r : fit.remarks)
    if (r.find(words) != std::string::npos) return true;
  return false;
}

TEST(ForceOffset, IsTakenOffAndSaid) {
  for (const double offset : {0.5, -0.5, 0.02}) {
    const ExperimentFit fit = fitted({.offset = offset});
    const PairLaw& law = fit.card.pairs.at(0);
    EXPECT_EQ(law.status, LawStatus::good) << law.reason;
    EXPECT_TRUE(says(fit, "was subtracted from all forces")) << offset;
    for (const double d : {0.1, 0.2, 0.3})
      EXPECT_NEAR(kUnit * law.normal.value(d), kUnit * KnownLaw{}.value(d), 0.01) << offset << " at " << d;
    for (const ForcePoint& p : fit.curves[0].samples[0].normal)
      EXPECT_NEAR(p.force, kUnit * law.normal.value(p.delta), 5.0 * 0.002) << p.delta;
    const auto band = value_interval(law, LawPart::normal, 0.25);
    ASSERT_TRUE(band);
    EXPECT_LE(band->low, KnownLaw{}.value(0.25));
    EXPECT_GE(band->high, KnownLaw{}.value(0.25));
  }
  const ExperimentFit kept = fitted({.offset = 0.5}, false);
  EXPECT_FALSE(says(kept, "offset"));
  EXPECT_GT(std::abs(kUnit * (kept.card.pairs.at(0).normal.value(0.2) - KnownLaw{}.value(0.2))), 0.05);
}

/// Of all curves without one about one in a thousand may be said to have an offset.
TEST(ForceOffset, IsNotSeenWhereThereIsNone) {
  int seen = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed)
    seen += static_cast<int>(force_offsets(pressed({.noise = 0.01, .seed = seed})).size());
  EXPECT_LE(seen, 2);
  EXPECT_TRUE(force_offsets(pressed({.noise = 0.0})).empty());
  EXPECT_TRUE(force_offsets(pressed({.noise = 0.0, .points = 5})).empty());
  ForceCurves flat = pressed({});
  for (ForcePoint& p : flat.samples[0].normal) p.force = 0.0;
  EXPECT_TRUE(force_offsets(flat).empty());
}

TEST(ForceOffset, ReadingsBeforeTouchAreEnough) {
  const Pressed late{.offset = 0.5, .first = 0.08, .before = 5};
  const auto found = force_offsets(pressed(late));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].determined);
  EXPECT_NEAR(found[0].force, 0.5, 0.005);
  EXPECT_EQ(fitted(late).card.pairs.at(0).status, LawStatus::good);
}

/// Offset and threshold stand for each other where a curve begins far above its threshold.
TEST(ForceOffset, WhatTooFewReadingsTellIsOpen) {
  for (const double first : {0.04, 0.06, 0.07}) {
    const auto few = force_offsets(pressed({.offset = 0.5, .points = 12, .first = first}));
    ASSERT_EQ(few.size(), 1U) << first;
    EXPECT_TRUE(few[0].determined) << first;
    EXPECT_NEAR(few[0].force, 0.5, 2.0 * few[0].error + 0.01) << first;
    EXPECT_LT(few[0].error, 0.03) << first;
  }
  const Pressed late{.offset = 1.5, .first = 0.12};
  const auto found = force_offsets(pressed(late));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_FALSE(found[0].determined);
  const ExperimentFit fit = fitted(late);
  EXPECT_EQ(fit.card.pairs.at(0).status, LawStatus::underdetermined);
  EXPECT_TRUE(says(fit, "record some before touch")) << fit.remarks.size();
}

/// Readings of a machine that touches at `touch` (over Rs) while it counts from its own zero.
ForceCurves counted_from_elsewhere(double touch, int before, double offset) {
  ForceCurves curves = pressed({.offset = offset, .points = 60, .first = 0.005});
  ForceCurve& curve = curves.samples[0];
  std::vector<ForcePoint> all;
  for (int k = before; k > 0; --k) all.push_back({touch - 0.005 * k, offset + 0.002 * (k % 2), std::nan("")});
  for (const ForcePoint& p : curve.normal) all.push_back({touch + p.delta, p.force, std::nan("")});
  curve.normal = std::move(all);
  return curves;
}

TEST(ForceOffset, ReadingsFarFromZeroWithoutContactQuestionTheTouchPoint) {
  for (const double offset : {0.0, 0.5}) {
    const std::string doubt = touch_doubt(counted_from_elsewhere(0.27, 12, offset));
    EXPECT_NE(doubt.find("those of 1 of 1 samples begin at 3.36 mm"), std::string::npos) << doubt;
    EXPECT_NE(doubt.find("# touch = "), std::string::npos) << doubt;
  }
  EXPECT_EQ(touch_doubt(pressed({})), "");
  EXPECT_EQ(touch_doubt(pressed({.offset = 0.5, .before = 5})), "");
  EXPECT_EQ(touch_doubt(pressed({.offset = 1.5, .first = 0.12})), "") << "in contact from the first reading on";
  ForceCurves known = counted_from_elsewhere(0.27, 12, 0.5);
  known.samples[0].before_touch = {0.5, 0.5};
  EXPECT_EQ(touch_doubt(known), "") << "overlaps below zero say where touch was";
}

TEST(ForceOffset, EverySampleHasItsOwn) {
  ForceCurves curves = pressed({.offset = 0.5});
  curves.samples.push_back(pressed({.offset = -0.2, .seed = 4}).samples[0]);
  curves.samples.push_back(pressed({.seed = 5}).samples[0]);
  curves.samples[1].name = "B";
  curves.samples[2].name = "C";
  const auto found = subtract_offsets(curves);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[1].force, -0.2, 0.005);
  ASSERT_EQ(curves.remarks.size(), 1U) << "said once for all";
  const std::string& said = curves.remarks.front();
  EXPECT_NE(said.find("2 of 3 samples (most in \"A\")"), std::string::npos) << said;
  EXPECT_NE(said.find("offset of -0."), std::string::npos) << said;
  EXPECT_NE(said.find("was subtracted from all forces of each sample"), std::string::npos) << said;
  EXPECT_TRUE(subtract_offsets(curves).empty());
}

TEST(ForceOffset, OpenOnesAreSaidOnceBesideThoseThatWereSubtracted) {
  const Pressed late{.offset = 1.5, .first = 0.12};
  ForceCurves curves = pressed(late);
  curves.samples.push_back(pressed(late).samples[0]);
  curves.samples.push_back(pressed({.offset = 0.5}).samples[0]);
  ASSERT_EQ(subtract_offsets(curves).size(), 3U);
  ASSERT_EQ(curves.remarks.size(), 2U);
  EXPECT_NE(curves.remarks[0].find("sample \"A\": a constant force offset of "), std::string::npos)
      << curves.remarks[0];
  EXPECT_NE(curves.remarks[1].find("2 of 3 samples"), std::string::npos) << curves.remarks[1];
  EXPECT_NE(curves.remarks[1].find("record some before touch"), std::string::npos) << curves.remarks[1];
}

}  // namespace
