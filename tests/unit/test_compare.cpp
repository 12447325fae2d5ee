// Comparison helpers on known answers: nothing differs, a known amount differs, nothing can be compared.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <sstream>
#include <string>

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
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(CompareSides, OnlyFilesOfPackingsAreLeftOut) {
  EXPECT_TRUE(holds_packings("material_initial", "material"));
  EXPECT_TRUE(holds_packings("macro_initial_dry", "macro"));
  EXPECT_FALSE(holds_packings("material_initially-loose", "material"));
  EXPECT_FALSE(holds_packings("macro_initial-state", "macro"));
}

/// The zeros of a law that crossed no threshold are not its numbers.
TEST(CompareLaws, ALawWithoutNumbersHasNone) {
  LawCard good = synthetic::card();
  LawCard none = good;
  none.pairs.at(0).status = LawStatus::no_threshold_crossing;
  none.pairs.at(0).normal = {};
  const std::vector<LawRow> rows = compare_laws(none, good, good.pairs.at(0).kind);
  ASSERT_GT(rows.size(), 3U);
  for (const LawRow& r : rows) {
    EXPECT_TRUE(std::isnan(r.candidate) && std::isnan(r.candidate_error)) << r.what;
    EXPECT_FALSE(std::isnan(r.reference)) << r.what;
  }
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
  EXPECT_THROW(compare_curves({}, one), InputError);
  EXPECT_THROW(compare_curves(one, {}), InputError);
  EXPECT_THROW(compare_curves(one, {macro_curve("shelled", 5, 1.0)}), InputError);
  EXPECT_THROW(compare_curves(synthetic::macro(), one), InputError);  // sample 0 under two engines
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
  CompareResult result;
  result.relaxations = {c};
  std::istringstream lines(to_text(result));
  int rows = 0;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  Fn ")) continue;
    ++rows;
    EXPECT_LT(line.size(), 99U) << "lines of 100 are broken at their spaces, and columns are lost: " << line;
  }
  EXPECT_EQ(rows, 6);
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
  EXPECT_THROW(compare_relaxations(data, "published", "damped", PairKind::soft_soft), InputError);
}

TEST(CompareRelaxations, NeedsAPackingInCommon) {
  Measurements data;
  data.packings = {synthetic::packing(0), synthetic::packing(1)};
  data.runs = {synthetic::packing_run(0, PairKind::soft_solid, "published", 1.0, data.spec),
               synthetic::packing_run(1, PairKind::soft_solid, "damped", 1.0, data.spec)};
  EXPECT_THROW(compare_relaxations(data, "published", "damped", PairKind::soft_solid), InputError);
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
  EXPECT_THROW(compare_measurements(candidate, "none", reference, "damped", PairKind::soft_solid), InputError);
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
  EXPECT_THROW(compare_sides(law, CompareSide{}), InputError);
  EXPECT_THROW(compare_within(law), InputError);
}

/// Curves that say what they start from and which law they were made with.
std::vector<MacroCurve> stated(const std::string& engine, const std::string& hash = "law 1") {
  std::vector<MacroCurve> curves = curves_of(synthetic::macro(), engine);
  for (MacroCurve& c : curves) {
    c.start = {0.01, 0.016, 5e5, 0.3, 0.3, 0.0, 0.16, 0.16, 0.16, "start " + std::to_string(c.sample)};
    if (engine == "law") c.law = {LawForm::directional, 0.7, 5e5, 0.3, 0.3, hash};
  }
  return curves;
}

CompareSide side_of(std::vector<MacroCurve> curves) {
  CompareSide side;
  side.macro = std::move(curves);
  return side;
}

std::string all_of(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

TEST(CompareSides, WhatCannotBeMeantIsRefusedUnlessToldOtherwise) {
  const CompareSide law = side_of(stated("law"));
  EXPECT_EQ(all_of(compare_sides(law, side_of(stated("shelled"))).differences), "");
  struct Change {
    const char* says;
    std::function<void(MacroCurve&)> make;
  };
  const std::vector<Change> changes{
      {"bodies: 320 against 321", [](MacroCurve& c) { c.bodies = 321; }},
      {"soft particles: 200 against 100", [](MacroCurve& c) { c.soft = 100; }},
      {"radii of bodies: 0.01 to 0.016 m against 0.01 to 0.02 m",
       [](MacroCurve& c) { c.start.radius_max = 0.02, c.start.bodies = "other"; }},
      {"bodies start elsewhere", [](MacroCurve& c) { c.start.bodies = "other"; }},
      {"E of the grains [Pa]: 500000 against 1000000", [](MacroCurve& c) { c.start.youngs_modulus = 1e6; }},
      {"measured with nu = 0.3, the grains of the twin have nu = 0.2",
       [](MacroCurve& c) { c.start.poisson_ratio = 0.2; }},
      {"mu of the walls: 0 against 0.2", [](MacroCurve& c) { c.start.wall_friction = 0.2; }},
      {"mu_r of the grains: 0 against 0.1", [](MacroCurve& c) { c.start.rolling.friction = 0.1; }},
      {"test: oedometric against isotropic", [](MacroCurve& c) { c.test = MacroTest::isotropic; }},
      {"preload of the test: 0 against 0.1", [](MacroCurve& c) { c.preload = 0.1; }}};
  for (const Change& change : changes) {
    std::vector<MacroCurve> twin = stated("shelled");
    for (MacroCurve& c : twin) change.make(c);
    const std::string message = message_of([&] { compare_sides(law, side_of(twin)); });
    EXPECT_NE(message.find(change.says), std::string::npos) << change.says << " not in " << message;
    EXPECT_NE(message.find("--different"), std::string::npos) << message;
    const CompareResult told = compare_sides(law, side_of(twin), true);
    EXPECT_NE(all_of(told.differences).find(change.says), std::string::npos) << all_of(told.differences);
    EXPECT_NE(to_text(told).find(change.says), std::string::npos);
    EXPECT_NE(to_json(told)["differences"].dump().find(change.says), std::string::npos);
    ASSERT_EQ(told.macro.size(), 1U) << change.says;
    EXPECT_EQ(told.macro[0].result.samples.size(), 2U) << change.says;
  }
}

TEST(CompareSides, TwoLawsOnOtherSamplesAreComparedAndSaidToBe) {
  std::vector<MacroCurve> other = stated("law", "law 2");
  for (MacroCurve& c : other) c.start.bodies += ", another seed";
  other.pop_back();
  const CompareResult result = compare_sides(side_of(stated("law")), side_of(other));
  const std::string said = all_of(result.differences);
  EXPECT_NE(said.find("bodies start elsewhere: another seed"), std::string::npos) << said;
  EXPECT_NE(said.find("hash law 1; against directional law at solid fraction 0.7000"), std::string::npos) << said;
  EXPECT_NE(all_of(result.macro.at(0).result.left_out).find("reference has no such sample"), std::string::npos);
  const CompareResult reverse = compare_sides(side_of(other), side_of(stated("law")));
  EXPECT_NE(all_of(reverse.macro.at(0).result.left_out).find("sample 1: the candidate has no such sample"),
            std::string::npos);
  const CompareResult before = compare_sides(side_of(stated("law")), side_of(curves_of(synthetic::macro(), "law")));
  EXPECT_NE(all_of(before.differences).find("the reference is of an earlier version"), std::string::npos);
}

TEST(CompareSides, WhatNobodyKnowsIsNoDifference) {
  CompareSide a;
  CompareSide b;
  a.measurements = b.measurements = synthetic::measurements();
  const SoftParticleSpec known = a.measurements->spec;
  b.measurements->spec = unknown_soft_particle(known.shell_radius, known.youngs_modulus);
  const std::string said = all_of(compare_sides(a, b).differences);
  EXPECT_NE(said.find("mu of the grains: not known of the reference"), std::string::npos) << said;
  EXPECT_EQ(said.find("nan"), std::string::npos) << said;
  a.measurements->spec = b.measurements->spec;
  EXPECT_EQ(all_of(compare_sides(a, b).differences), "");
}

TEST(CompareSides, MeasurementsOfOtherPackingsAreRefusedAndOtherScalesAreSaid) {
  CompareSide a;
  CompareSide b;
  a.measurements = b.measurements = synthetic::measurements();
  EXPECT_EQ(all_of(compare_sides(a, b).differences), "");
  b.measurements->spec.youngs_modulus *= 2.0;
  b.measurements->spec.shell_radius *= 3.0;
  const std::string said = all_of(compare_sides(a, b).differences);
  EXPECT_NE(said.find("E of the grains [Pa]: 500000 against 1000000"), std::string::npos) << said;
  EXPECT_NE(said.find("Rs [m]: 0.016 against 0.048"), std::string::npos) << said;
  b = a;
  b.measurements->packings[0].grains += 1;
  EXPECT_NE(all_of(compare_sides(a, b).differences).find("packings: not the same ones"), std::string::npos);
  const std::vector<std::pair<const char*, std::function<void(SoftParticleSpec&)>>> changes{
      {"exponent of the radii: 3.5 against 3", [](SoftParticleSpec& s) { s.exponent = 3.0; }},
      {"polydispersity: 10 against 5", [](SoftParticleSpec& s) { s.polydispersity = 5.0; }},
      {"largest grain over Rs: 0.5 against 0.4", [](SoftParticleSpec& s) { s.rmax_over_shell = 0.4; }},
      {"packing, beta: 3 against 2", [](SoftParticleSpec& s) { s.beta = 2.0; }},
      {"packing, trials: 10000 against 100", [](SoftParticleSpec& s) { s.trials = 100; }},
      {"nu of the grains: 0.3 against 0.2", [](SoftParticleSpec& s) { s.poisson_ratio = 0.2; }},
      {"mu of the grains: 0.3 against 0.5", [](SoftParticleSpec& s) { s.friction = 0.5; }}};
  for (const auto& [says, change] : changes) {
    b = a;
    change(b.measurements->spec);
    const std::string message = message_of([&] { compare_sides(a, b); });
    EXPECT_NE(message.find(says), std::string::npos) << says << " not in " << message;
    EXPECT_NE(all_of(compare_sides(a, b, true).differences).find(says), std::string::npos);
    CompareSide card_a;
    CompareSide card_b;
    card_a.card = card_b.card = synthetic::card();
    change(card_b.card->spec);
    EXPECT_NE(message_of([&] { compare_sides(card_a, card_b); }).find(says), std::string::npos) << says;
  }
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
