// Comparison helpers on known answers: nothing differs, a known amount differs, nothing can be compared.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "common/core/error.h"
#include "pipelines/compare/compare.h"
#include "pipelines/compare/compare_inputs.h"
#include "pipelines/compare/compare_measurements.h"
#include "tests/support/synthetic_run.h"

namespace softgrain {
namespace {

using synthetic::macro_curve;
using Values = std::vector<double>;

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const BadInput& error) {
    return error.what();
  }
  return "";
}

TEST(RelativeDifference, IdenticalCurvesDoNotDiffer) {
  const Values x{0, 1, 3};
  const Values y{1, 5, 2};
  EXPECT_EQ(relative_difference(x, y, x, y), 0.0);
}

TEST(RelativeDifference, IsTheKnownNumberForAConstantFactor) {
  EXPECT_NEAR(relative_difference({0, 1, 3}, {1.2, 6, 2.4}, {0, 1, 3}, {1, 5, 2}), 0.2, 1e-14);
}

TEST(RelativeDifference, IntegratesExactlyOnDifferentGrids) {
  // candidate 1, reference x over [0, 2]: int (1-x)^2 = 2/3, int x^2 = 8/3
  EXPECT_NEAR(relative_difference({0, 2}, {1, 1}, {0, 0.7, 1.1, 2}, {0, 0.7, 1.1, 2}), 0.5, 1e-14);
}

TEST(RelativeDifference, UsesOnlyTheCommonRange) {
  // they agree on [1, 2] and differ outside
  EXPECT_NEAR(relative_difference({0, 1, 2}, {50, 1, 2}, {1, 2, 3}, {1, 2, 70}), 0.0, 1e-14);
}

TEST(RelativeDifference, NamesWhatIsWrong) {
  EXPECT_NE(message_of([] {
              relative_difference({}, {}, {0, 1}, {1, 1});
            }).find("fewer than two points"),
            std::string::npos);
  EXPECT_NE(message_of([] {
              relative_difference({0, 1}, {1, 1}, {2, 3}, {1, 1});
            }).find("no common range"),
            std::string::npos);
  EXPECT_NE(message_of([] { relative_difference({0, 1}, {1, 1}, {0, 1}, {0, 0}); }).find("zero"), std::string::npos);
  EXPECT_NE(message_of([] {
              relative_difference({0, 0}, {1, 1}, {0, 1}, {1, 1});
            }).find("does not increase"),
            std::string::npos);
  EXPECT_NE(message_of([] {
              relative_difference({0, 1}, {1, NAN}, {0, 1}, {1, 1});
            }).find("not finite"),
            std::string::npos);
  EXPECT_NE(message_of([] { relative_difference({0, 1}, {1}, {0, 1}, {1, 1}); }).find("abscissae"), std::string::npos);
}

TEST(CompareCurves, EqualSetsGiveZeroAndUnitRatios) {
  const std::vector<MacroCurve> set{macro_curve("law", 0, 1.0), macro_curve("law", 1, 1.3)};
  const Comparison c = compare_curves(set, set);
  EXPECT_EQ(c.axial_difference.mean, 0.0);
  EXPECT_EQ(c.lateral_difference.mean, 0.0);
  EXPECT_EQ(c.axial_end_ratio.mean, 1.0);
  EXPECT_EQ(c.speedup_seconds, 1.0);
}

TEST(CompareCurves, AFactorOfOneTenthShowsAsNineTenths) {
  const Comparison c = compare_curves({macro_curve("law", 0, 0.1), macro_curve("law", 1, 0.3)},
                                      {macro_curve("shelled", 0, 1.0), macro_curve("shelled", 1, 1.0)});
  ASSERT_EQ(c.samples.size(), 2U);
  EXPECT_NEAR(c.samples[0].axial_difference, 0.9, 1e-12);
  EXPECT_NEAR(c.samples[1].axial_difference, 0.7, 1e-12);
  EXPECT_NEAR(c.axial_difference.mean, 0.8, 1e-12);
  EXPECT_NEAR(c.axial_difference.error, 0.1, 1e-12);  // half the difference of two
  EXPECT_NEAR(c.axial_end_ratio.mean, 0.2, 1e-12);
  EXPECT_NEAR(c.lateral_stress_ratio_candidate.mean, 0.45, 1e-12);
  EXPECT_NEAR(c.speedup_seconds, 610.0 / 1.5, 1e-9);
  EXPECT_NEAR(c.speedup_contact_evaluations, 400.0, 1e-9);
}

TEST(CompareCurves, LeavesOutUnusableAndLonelySamplesAndSaysSo) {
  auto bad = macro_curve("law", 1, 0.5);
  bad.usable = false;
  bad.note = "did not converge";
  const Comparison c = compare_curves({macro_curve("law", 0, 0.9), bad, macro_curve("law", 7, 1.0)},
                                      {macro_curve("shelled", 0, 1.0), macro_curve("shelled", 1, 1.0)});
  EXPECT_EQ(c.samples.size(), 1U);
  ASSERT_EQ(c.left_out.size(), 2U);
  EXPECT_NE(c.left_out[0].find("did not converge"), std::string::npos);
  EXPECT_NE(c.left_out[1].find("sample 7"), std::string::npos);
}

TEST(CompareCurves, RefusesEmptyAmbiguousAndForeignSets) {
  const std::vector<MacroCurve> one{macro_curve("law", 0, 1.0)};
  EXPECT_THROW(compare_curves({}, one), BadInput);
  EXPECT_THROW(compare_curves(one, {}), BadInput);
  EXPECT_THROW(compare_curves(one, {macro_curve("shelled", 5, 1.0)}), BadInput);
  EXPECT_THROW(compare_curves(synthetic::macro(), one), BadInput);  // sample 0 under two engines
}

TEST(CompareCurves, ALateralStressThatWasNotRecordedDoesNotHideTheAxialOne) {
  auto candidate = macro_curve("law", 0, 1.0);
  candidate.stress_lateral.clear();
  const Comparison c = compare_curves({candidate}, {macro_curve("shelled", 0, 1.0)});
  EXPECT_EQ(c.axial_difference.mean, 0.0);
  EXPECT_EQ(c.lateral_difference.n, 0U);
  EXPECT_TRUE(std::isnan(c.lateral_difference.mean));
}

/// Nothing is relative to a stress of zero; the other samples are still compared.
TEST(CompareCurves, WhatIsRelativeToZeroIsUndefined) {
  const auto silent = [](int sample, const char* engine) {
    MacroCurve c = macro_curve(engine, sample, 1.0, 4);
    std::fill(c.stress_axial.begin(), c.stress_axial.end(), 0.0);
    std::fill(c.stress_lateral.begin(), c.stress_lateral.end(), 0.0);
    return c;
  };
  const std::vector<MacroCurve> twins{macro_curve("shelled", 0, 1.0, 4), macro_curve("shelled", 1, 1.0, 4)};
  EXPECT_TRUE(compare_curves({macro_curve("law", 0, 0.9, 4)}, twins).undefined.empty());
  const Comparison law = compare_curves({silent(0, "law"), macro_curve("law", 1, 0.9, 4)}, twins);
  ASSERT_EQ(law.undefined.size(), 1U);
  EXPECT_NE(law.undefined[0].find("sample 0: the candidate carries no axial stress"), std::string::npos);
  EXPECT_EQ(law.samples.size(), 2U);
  EXPECT_TRUE(std::isnan(law.samples[0].lateral_stress_ratio_candidate));
  const Comparison twin = compare_curves({macro_curve("law", 0, 0.9, 4), macro_curve("law", 1, 0.9, 4)},
                                         {silent(0, "shelled"), macro_curve("shelled", 1, 1.0, 4)});
  EXPECT_EQ(twin.undefined.size(), 1U);
  EXPECT_EQ(twin.samples.size(), 1U);
  EXPECT_THROW((void)compare_curves({macro_curve("law", 0, 0.9, 4)}, {silent(0, "shelled")}), ZeroReference);

  CompareSide a;
  CompareSide b;
  a.macro = {macro_curve("law", 0, 0.9, 4)};
  b.macro = {silent(0, "shelled")};
  const CompareResult result = compare_sides(a, b);
  EXPECT_EQ(result.undefined.size(), 1U);
  EXPECT_NE(to_text(result).find("undefined: "), std::string::npos);
  b.macro = {macro_curve("shelled", 0, 0.9, 4)};
  a.macro = {silent(0, "law")};
  const std::string text = to_text(compare_sides(a, b));
  EXPECT_NE(text.find("undefined against"), std::string::npos) << text;
  EXPECT_EQ(text.find("nan"), std::string::npos) << text;
  EXPECT_EQ(text.find("inf"), std::string::npos) << text;
}

TEST(Statistics, MeanDeviationAndErrorOfThreeNumbers) {
  const MeanError m = mean_error(Values{1.0, 2.0, 6.0});
  EXPECT_DOUBLE_EQ(m.mean, 3.0);
  EXPECT_NEAR(m.deviation, std::sqrt(7.0), 1e-14);
  EXPECT_NEAR(m.error, std::sqrt(7.0 / 3.0), 1e-14);
  EXPECT_TRUE(std::isnan(mean_error(Values{2.0}).error));
  EXPECT_TRUE(std::isnan(mean_error(Values{}).mean));
}

TEST(Statistics, JackknifeOfARatio) {
  EXPECT_NEAR(paired_ratio(Values{2, 4, 6}, Values{1, 2, 3}).ratio, 2.0, 1e-14);
  EXPECT_NEAR(paired_ratio(Values{2, 4, 6}, Values{1, 2, 3}).error, 0.0, 1e-14);
  // with a constant reference the jackknife error is the standard error of the mean, over the reference
  const Values a{1.0, 2.0, 6.0};
  EXPECT_NEAR(paired_ratio(a, Values{2, 2, 2}).error, 0.5 * mean_error(a).error, 1e-14);
  EXPECT_THROW(paired_ratio(a, Values{1, 2}), BadInput);
}

TEST(CompareRelaxations, FindsTheFactorThatWasPutIn) {
  const auto data = synthetic::measurements();
  const auto c = compare_relaxations(data, "published", "damped", PairKind::soft_solid);
  ASSERT_EQ(c.normal.size(), 6U);
  for (const RatioRow& row : c.normal) {
    if (row.reference.mean == 0.0) continue;  // below the threshold
    EXPECT_EQ(row.reference.n, row.delta > 0.09 && row.delta < 0.11 ? 7U : 8U) << "one point did not converge";
    EXPECT_NEAR(row.ratio.ratio, 1.0 / 0.96, 1e-12);
    EXPECT_NEAR(row.ratio.error, 0.0, 1e-12);
  }
  ASSERT_FALSE(c.stiffness_initial.empty());
  EXPECT_NEAR(c.stiffness_initial.back().ratio.ratio, 1.0 / 0.96, 1e-9);
  EXPECT_NEAR(c.stiffness_secant.back().ratio.ratio, 1.0 / 0.96, 1e-9);
  EXPECT_NEAR(c.reference_normal_cost.loop_passes, 40000.0, 1e-9);
  EXPECT_NEAR(c.candidate_normal_cost.seconds, 0.4 / 6.0, 1e-12);
}

TEST(CompareRelaxations, StiffnessIsInNewtonPerMetre) {
  const auto data = synthetic::measurements();
  const auto c = compare_relaxations(data, "damped", "damped", PairKind::soft_solid);
  double mean = 0.0;
  for (int i = 0; i < 12; ++i) mean += std::max(0.1, 1.0 + 0.05 / 0.3 * synthetic::wobble(i, 6)) / 12.0;
  const double expected =
      mean * data.spec.youngs_modulus * data.spec.shell_radius * synthetic::law(synthetic::kKtA, synthetic::kKtB, 0.3);
  EXPECT_NEAR(c.stiffness_secant.back().reference.mean, expected / std::sqrt(5.0), 1e-6 * expected);
  EXPECT_NEAR(c.stiffness_initial.back().reference.mean, expected, 0.01 * expected);
}

TEST(CompareRelaxations, APackingThatRearrangedUnderRotationIsNamedAndLeftOutBeside) {
  auto data = synthetic::measurements();
  for (PackingRun& run : data.runs) {
    if (run.packing != 3 || run.kind != PairKind::soft_solid || run.relaxation != "published") continue;
    for (TangentialPoint& p : run.tangential)
      if (delta_key(p.delta) == delta_key(run.tangential.back().delta)) p.force_parallel *= -20.0;
  }
  const auto c = compare_relaxations(data, "published", "damped", PairKind::soft_solid);
  const RatioRow& row = c.stiffness_initial.back();
  EXPECT_EQ(row.jumps, 1U);
  EXPECT_NEAR(row.ratio_without_jumps.ratio, 1.0 / 0.96, 1e-9);
  EXPECT_EQ(row.reference.n, 8U) << "it stays in the means";
  EXPECT_LT(row.ratio.ratio, 0.0);
  EXPECT_EQ(c.stiffness_initial.front().jumps, 0U);
  EXPECT_EQ(c.stiffness_secant.back().jumps, 0U);
}

TEST(CompareRelaxations, NamesWhatIsThereWhenOneIsMissing) {
  const auto data = synthetic::measurements();
  const auto message = message_of([&] { compare_relaxations(data, "published", "swift", PairKind::soft_solid); });
  EXPECT_NE(message.find("swift"), std::string::npos);
  EXPECT_NE(message.find("damped, published"), std::string::npos);
  EXPECT_THROW(compare_relaxations(data, "published", "damped", PairKind::soft_soft), BadInput);
}

TEST(CompareRelaxations, NeedsAPackingInCommon) {
  Measurements data;
  data.packings = {synthetic::packing(0), synthetic::packing(1)};
  data.runs = {synthetic::packing_run(0, PairKind::soft_solid, "published", 1.0, data.spec),
               synthetic::packing_run(1, PairKind::soft_solid, "damped", 1.0, data.spec)};
  EXPECT_THROW(compare_relaxations(data, "published", "damped", PairKind::soft_solid), BadInput);
}

TEST(CompareMeasurements, DimensionlessSoThatStiffnessOfTheGrainsDropsOut) {
  const auto reference = synthetic::measurements();
  auto candidate = reference;
  candidate.spec.youngs_modulus *= 256.0;
  for (PackingRun& run : candidate.runs) {
    for (NormalPoint& p : run.normal) p.force *= 256.0;
    for (TangentialPoint& p : run.tangential) p.force_parallel *= 256.0;
  }
  candidate.packings[0].grains += 1;
  const auto c = compare_measurements(candidate, "damped", reference, "damped", PairKind::soft_solid);
  EXPECT_FALSE(c.paired);
  EXPECT_NEAR(c.normal.back().ratio.ratio, 1.0, 1e-12);
  EXPECT_GT(c.normal.back().ratio.error, 0.0);
  EXPECT_NEAR(c.stiffness_initial.back().ratio.ratio, 1.0, 1e-12);
  EXPECT_THROW(compare_measurements(candidate, "none", reference, "damped", PairKind::soft_solid), BadInput);
}

TEST(CompareMeasurements, TheSamePackingsArePaired) {
  const auto reference = synthetic::measurements();
  auto candidate = reference;
  for (PackingRun& run : candidate.runs)
    for (NormalPoint& p : run.normal) p.force *= 1.25;
  const auto c = compare_measurements(candidate, "damped", reference, "damped", PairKind::soft_solid);
  EXPECT_TRUE(c.paired);
  EXPECT_NEAR(c.normal.back().ratio.ratio, 1.25, 1e-12);
  EXPECT_NEAR(c.normal.back().ratio.error, 0.0, 1e-12);  // the scatter of the packings is the same on both sides
  EXPECT_GT(c.normal.back().candidate.error, 0.0);
  EXPECT_GT(c.candidate_normal_cost.points, 0);
}

TEST(CompareWithin, FindsEnginesAndRelaxationsOfOneRun) {
  CompareSide side;
  side.macro = synthetic::macro();
  side.measurements = synthetic::measurements();
  const CompareResult result = compare_within(side);
  ASSERT_EQ(result.macro.size(), 1U);
  ASSERT_EQ(result.relaxations.size(), 1U);
  EXPECT_NEAR(result.macro[0].result.samples[0].axial_difference, 0.2, 1e-12);
  EXPECT_FALSE(to_text(result).empty());
  EXPECT_NEAR(to_json(result)["relaxations"][0]["normal_force"][5]["ratio"].get<double>(), 1.0 / 0.96, 1e-12);
}

TEST(CompareSides, ComparesEqualEnginesOrElseTheFirstOfEach) {
  CompareSide law;
  CompareSide twin;
  law.macro = curves_of(synthetic::macro(), "law");
  twin.macro = curves_of(synthetic::macro(), "shelled");
  const CompareResult different = compare_sides(law, twin);
  EXPECT_EQ(different.macro.at(0).reference_engine, "shelled");
  EXPECT_EQ(compare_sides(law, law).macro.at(0).result.axial_difference.mean, 0.0);
  EXPECT_THROW(compare_sides(law, CompareSide{}), BadInput);
  EXPECT_THROW(compare_within(law), BadInput);
}

TEST(CompareSides, LawCardsSideBySide) {
  CompareSide a;
  CompareSide b;
  a.card = synthetic::card();
  b.card = synthetic::card();
  b.card->pairs[0].normal.a.value *= 2.0;
  b.card->pairs[0].normal.c.value *= 2.0;
  const CompareResult result = compare_sides(a, b);
  ASSERT_EQ(result.laws.size(), 2U);
  const LawRow& parameter = result.laws[0].rows.front();
  EXPECT_NEAR(parameter.reference / parameter.candidate, 2.0, 1e-12);
  const LawRow& force = result.laws[0].rows.back();
  EXPECT_NEAR(force.reference / force.candidate, 2.0, 1e-12);
  EXPECT_EQ(result.laws[1].rows.front().candidate, result.laws[1].rows.front().reference);
}

}  // namespace
}  // namespace softgrain
