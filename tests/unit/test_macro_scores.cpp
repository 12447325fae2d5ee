// Scores of engines against resolved twins.
#include <gtest/gtest.h>

#include <cmath>

#include "pipelines/compare/macro_scores.h"
#include "tests/support/synthetic_run.h"

namespace softgrain {
namespace {

MacroCurve curve(const std::string& engine, int sample, double factor) {
  MacroCurve c = synthetic::macro_curve(engine, sample, factor);
  c.stress_deviator = c.stress_axial;
  c.coordination_bodies.assign(c.strain.size(), 4.0 * factor);
  c.fabric_bodies.assign(c.strain.size(), 0.1 * factor);
  c.body_forces = {1.0 * factor, 2.0 * factor, 3.0 * factor};
  c.cost = engine == "shelled" ? Cost{10, 5000, 20.0} : Cost{10, 100, 2.0};
  return c;
}

TEST(MacroScores, MeanAndVariation) {
  const auto [mean, variation] = mean_and_variation({1.0, 2.0, 3.0});
  EXPECT_DOUBLE_EQ(mean, 2.0);
  EXPECT_DOUBLE_EQ(variation, 0.5);
  EXPECT_TRUE(std::isnan(mean_and_variation({}).first));
}

/// Found by fuzzing: forces over a mean of zero, and a comparison that never ended.
TEST(MacroScores, ForcesOfZeroHaveNoDistance) {
  MacroCurve silent = curve("law", 0, 0.9);
  silent.body_forces = {0.0, 0.0, 0.0};
  const auto scores = score_engines({silent, curve("shelled", 0, 1.0)});
  EXPECT_EQ(scores[0].shelled.force_distance.n, 0U);
  EXPECT_EQ(scores[0].shelled.axial.n, 1U);
}

TEST(MacroScores, KolmogorovSmirnovDistance) {
  EXPECT_DOUBLE_EQ(kolmogorov_smirnov({3.0, 1.0, 2.0}, {1.0, 2.0, 3.0}), 0.0);
  EXPECT_DOUBLE_EQ(kolmogorov_smirnov({1.0, 2.0}, {5.0, 6.0, 7.0}), 1.0);
  EXPECT_DOUBLE_EQ(kolmogorov_smirnov({1.0, 3.0}, {2.0, 4.0}), 0.5);
  EXPECT_TRUE(std::isnan(kolmogorov_smirnov({}, {1.0})));
  EXPECT_TRUE(std::isnan(kolmogorov_smirnov({std::nan(""), 1.0}, {1.0}))) << "found by fuzzing: it never ended";
}

TEST(MacroScores, EveryEngineAgainstEveryTwin) {
  const auto scores = score_engines({curve("pair", 0, 0.5), curve("pair", 1, 0.75), curve("shelled", 0, 1.0),
                                     curve("shelled", 1, 1.0), curve("free", 0, 0.25)});
  ASSERT_EQ(scores.size(), 3U);
  const EngineScore& pair = scores[0];
  EXPECT_EQ(pair.engine, "pair");
  EXPECT_EQ(pair.samples, 2U);
  EXPECT_NEAR(pair.shelled.axial.mean, 0.375, 1e-12);
  EXPECT_NEAR(pair.shelled.axial_end.mean, 0.625, 1e-12);
  EXPECT_NEAR(pair.shelled.lateral_ratio.mean, 0.0, 1e-12);
  EXPECT_NEAR(pair.shelled.coordination.mean, -1.5, 1e-12);
  EXPECT_NEAR(pair.shelled.fabric.mean, -0.0375, 1e-12);
  EXPECT_NEAR(pair.shelled.force_mean.mean, 0.625, 1e-12);
  EXPECT_NEAR(pair.shelled.force_distance.mean, 0.0, 1e-12);
  EXPECT_NEAR(pair.shelled.speedup_evaluations, 50.0, 1e-12);
  EXPECT_NEAR(pair.shelled.speedup_seconds, 10.0, 1e-12);
  EXPECT_EQ(pair.shelled.deviator.n, 0U);  // no shear
  EXPECT_EQ(pair.free.axial.n, 1U);
  EXPECT_NEAR(pair.free.axial.mean, 1.0, 1e-12);
  EXPECT_EQ(scores[1].shelled.axial.n, 0U);
  EXPECT_NEAR(scores[1].free.axial.mean, 3.0, 1e-12);
}

TEST(MacroScores, TheDeviatorCountsAfterThePreload) {
  MacroCurve a = curve("pair", 0, 1.0);
  a.test = MacroTest::shear;
  for (double& e : a.strain) e -= 0.02;
  MacroCurve b = a;
  b.engine = "shelled";
  for (std::size_t k = 0; k < b.strain.size(); ++k)
    if (b.strain[k] < -1e-9) b.stress_deviator[k] *= 7.0;
  EXPECT_NEAR(score_engines({a, b})[0].shelled.deviator.mean, 0.0, 1e-12);
}

TEST(MacroScores, UnusableCurvesDoNotCount) {
  MacroCurve bad = curve("pair", 1, 9.0);
  bad.usable = false;
  const auto scores = score_engines({curve("pair", 0, 0.5), bad, curve("shelled", 0, 1.0), curve("shelled", 1, 1.0)});
  EXPECT_EQ(scores[0].samples, 1U);
  EXPECT_NEAR(scores[0].shelled.axial.mean, 0.5, 1e-12);
}

TEST(MacroScores, TheTableHasACellForEveryColumn) {
  const ScoreTable table = score_table(score_engines({curve("pair", 0, 0.5), curve("free", 0, 1.0)}));
  ASSERT_EQ(table.rows.size(), 2U);
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.header.size());
  EXPECT_EQ(table.rows[0][0], "pair");
}

}  // namespace
}  // namespace softgrain
