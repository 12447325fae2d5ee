// Moduli and strength of stages from curves whose numbers are known.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "common/core/vec.h"
#include "common/io/text_file.h"
#include "pipelines/compare/compare.h"
#include "pipelines/compare/macro_scores.h"
#include "pipelines/compare/stage_match.h"
#include "pipelines/compare/stage_results.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/macro/summary.h"
#include "pipelines/report/report.h"
#include "pipelines/results/set_summary.h"
#include "pipelines/results/summary.h"
#include "pipelines/runs/set_text.h"
#include "tests/support/stage_curves.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

using test::Elastic;
using test::pressed_and_slid;

TEST(StageResults, UndrainedAndSlidingStages) {
  const Elastic e = pressed_and_slid();
  const MacroCurve& c = e.curve;
  using K = StageKind;
  const auto results = stage_results(c);
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(modulus_of(K::undrained), Modulus::undrained);
  EXPECT_NEAR(results[0].modulus, 3.0 * e.shear, 1e-6 * e.shear);  // 3 G at constant volume
  EXPECT_TRUE(std::isnan(results[0].friction_peak));
  EXPECT_NEAR(results[1].modulus_begin / e.shear, 1.0, 0.5);
  EXPECT_NEAR(results[1].shear_end, 0.01, 1e-15);
  EXPECT_NEAR(results[1].friction_end, e.shear * 0.01 / c.stress_axial.back(), 1e-15);
  EXPECT_NEAR(results[1].friction_peak, e.shear * 0.016 / c.stress_axial.back(), 1e-15);
  EXPECT_NEAR(results[1].friction_peak_shear, 0.008, 1e-15);
  EXPECT_TRUE(std::isnan(results[1].ratio_peak_strain));  // z stands still
  EXPECT_NEAR(results[0].ratio_peak_strain, -std::expm1(-0.004), 1e-15);
  const double p = (c.stress_x.back() + c.stress_y.back() + c.stress_axial.back()) / 3.0;
  const double axial = c.stress_axial.back() - c.stress_x.back();
  EXPECT_NEAR(results[1].ratio_end, std::sqrt(axial * axial + 3.0 * std::pow(e.shear * 0.01, 2)) / p, 1e-12);
  // Summaries have every number that means are taken of, and only stages that slide have those of sliding.
  const auto means = stage_means({c}, "law");
  stage_numbers([&](const char* name, auto mean, auto result, const Means&) {
    EXPECT_EQ(json_of(means[1]).contains(name), std::isfinite(results[1].*result)) << name;
    EXPECT_EQ((means[1].*mean).has_value(), std::isfinite(results[1].*result)) << name;
  });
  EXPECT_EQ(json_of(means[1])["shear_over_normal_peak"]["mean"], results[1].friction_peak);
  EXPECT_FALSE(json_of(means[0]).contains("shear_strain_end"));
  EXPECT_EQ(deviators(c)[4], c.stress_deviator[4]);
  EXPECT_EQ(deviators(c).back(), 2.0 * c.stress_xz.back());
  EXPECT_EQ(deviators(c, StrainPart::axial), deviators(c));
  EXPECT_EQ(deviators(c, StrainPart::shear)[4], 2.0 * c.stress_xz[4]) << "where the stage that slides begins";
  EXPECT_EQ(deviators(c, StrainPart::shear).back(), deviators(c).back());
}

/// Each part begins where the one before it ends.
TEST(StageResults, PointsAreThoseOfStagesThatSlideOrOfTheOthers) {
  MacroCurve c = pressed_and_slid().curve;
  EXPECT_EQ(points_of_stages(c, StrainPart::axial), (std::vector<std::size_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(points_of_stages(c, StrainPart::shear), (std::vector<std::size_t>{4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(values_at(c.shear_strain, points_of_stages(c, StrainPart::shear)).size(), 6U);
  c.test = MacroTest::direct_shear;
  EXPECT_EQ(points_of_stages(c, StrainPart::shear).size(), c.strain.size());
  EXPECT_TRUE(points_of_stages(c, StrainPart::axial).empty());
  EXPECT_EQ(points_of_stages(c, StrainPart::whole).size(), c.strain.size());
}

/// Curves beside those of other runs, in reports and in the terminal: two drawings, as a run's own report has.
TEST(StageResults, CurvesOfStagesThatSlideAreApartInComparisons) {
  MacroCurve c = pressed_and_slid().curve;
  const std::vector<RunCurve> drawn = stress_curves({{"", {c}}});
  ASSERT_EQ(drawn.size(), 3U);
  EXPECT_EQ(drawn[0].plot, "Axial stress");
  EXPECT_EQ(drawn[0].x_label, "axial strain [%]");
  EXPECT_EQ(drawn[0].x.size(), 5U);
  EXPECT_EQ(drawn[1].plot, "Axial stress, stages that slide");
  EXPECT_EQ(drawn[1].x_label, "shear strain [%]");
  ASSERT_EQ(drawn[1].x.size(), 6U);
  EXPECT_NEAR(drawn[1].x.back(), 1.0, 1e-12);
  EXPECT_EQ(drawn[1].y.back(), c.stress_axial.back());
  EXPECT_EQ(drawn[2].plot, "Shear stress, stages that slide");
  EXPECT_EQ(drawn[2].x_label, "shear strain [%]");
  EXPECT_EQ(drawn[2].y_label, "shear stress");
  EXPECT_EQ(drawn[2].x, drawn[1].x);
  EXPECT_EQ(drawn[2].y.back(), c.stress_xz.back());
  EXPECT_TRUE(drawn[2].in_terminal && !drawn[1].in_terminal);
  EXPECT_EQ(strain_at_end(c).value, c.shear_strain.back());
  EXPECT_STREQ(strain_at_end(c).name, "shear strain");
  // The range that is compared has its shear strains apart.
  const SampleComparison compared = compare_curves({c}, {c}).samples.front();
  EXPECT_NEAR(compared.shear_low, 0.0, 1e-12);
  EXPECT_NEAR(compared.shear_high, 0.01, 1e-12);
  c.stages[1] = {"b", StageKind::undrained, StageKind::undrained};
  EXPECT_EQ(stress_curves({{"", {c}}}).size(), 1U);
  EXPECT_EQ(strain_at_end(c).value, c.strain.back());
  EXPECT_TRUE(std::isnan(compare_curves({c}, {c}).samples.front().shear_high));
}

/// Stresses of a macro run, and how far its law is from the twin, over what drives the stages.
TEST(StageResults, ReportsOfMacroRunsDrawStagesThatSlideOverTheirShearStrain) {
  const test::TemporaryDirectory directory;
  const MacroCurve law = pressed_and_slid().curve;
  MacroCurve twin = law;
  twin.engine = "shelled";
  for (double& s : twin.stress_axial) s *= 1.1;
  const auto page = [&](const std::vector<MacroCurve>& curves) {
    save_macro(curves, directory.file("macro.h5"));
    write_text_atomic(directory.file("summary.json"), R"({"status": "good", "kind": "pipeline"})");
    write_report(directory.path());
    return read_text(directory.file("report.html"));
  };
  const auto has = [](const std::string& html, const std::string& id) {
    return html.find("id=\"macro-stages-" + id + "-clip\"") != std::string::npos;
  };
  const std::string html = page({law, twin});
  for (const char* id : {"axial", "axial-sliding", "lateral-sliding", "axial-difference", "axial-difference-sliding"})
    EXPECT_TRUE(has(html, id)) << id;
  EXPECT_NE(html.find(", shear 0 .. 1<"), std::string::npos) << "the compared range of strain";
  MacroCurve pressed = law;
  pressed.stages[1] = {"b", StageKind::undrained, StageKind::undrained};
  const std::string one = page({pressed});
  EXPECT_TRUE(has(one, "axial"));
  EXPECT_FALSE(has(one, "axial-sliding"));
}

/// In the terminal too: the stress of stages that slide over their shear strain, below the others.
TEST(StageResults, TheTerminalDrawsStagesThatSlide) {
  const auto drawn = [](const MacroCurve& c) {
    const test::TemporaryDirectory directory;
    save_macro({c}, directory.file("macro.h5"));
    write_text_atomic(directory.file("summary.json"), R"({"status": "good", "kind": "macro"})");
    SetSummary set;
    set.runs = {{.name = "a", .directory = directory.path()}, {.name = "b", .directory = directory.path()}};
    return curves_text(set, "");
  };
  MacroCurve c = pressed_and_slid().curve;
  const std::string both = drawn(c);
  EXPECT_LT(both.find("axial strain [%]"), both.find("shear strain [%]")) << both;
  EXPECT_NE(both.find("shear stress [Pa]"), std::string::npos) << both;
  c.stages[1] = {"b", StageKind::undrained, StageKind::undrained};
  EXPECT_EQ(drawn(c).find("shear stress"), std::string::npos);
}

/// In the report of a material with several stages, those that slide have figures of their own.
TEST(StageResults, ReportsDrawStagesThatSlideOverTheirShearStrain) {
  const test::TemporaryDirectory directory;
  const auto page = [&](const MacroCurve& c) {
    save_macro({c}, directory.file("material.h5"));
    write_text_atomic(
        directory.file("summary.json"),
        R"({"status": "good", "kind": "material", "variants": [{"name": "material", "file": "material.h5"}]})");
    write_report(directory.path());
    return read_text(directory.file("report.html"));
  };
  const auto has = [](const std::string& html, const std::string& text) {
    return html.find(text) != std::string::npos;
  };
  const MacroCurve both = pressed_and_slid().curve;
  const std::string html = page(both);
  for (const char* id : {"material-axial", "material-axial-sliding", "material-ratio-sliding"})
    EXPECT_TRUE(has(html, std::string("id=\"") + id + "-clip\"")) << id;
  const std::string parts = report::stage_parts({both}, MacroTest::stages);
  for (const char* id : {"macro-stages-ratio", "macro-stages-ratio-sliding", "macro-stages-volume-sliding"})
    EXPECT_TRUE(has(parts, std::string("id=\"") + id + "-clip\"")) << id;
  EXPECT_TRUE(has(html, "shear strain [%]"));
  EXPECT_TRUE(has(html, "axial stress [kPa]")) << "stages have stresses in Pa";
  MacroCurve pressed = both;
  pressed.stages[1] = {"b", StageKind::undrained, StageKind::undrained};
  EXPECT_FALSE(has(page(pressed), "material-axial-sliding"));
}

/// K0 is that of stages without lateral strain, per sample.
TEST(StageResults, KZeroIsLateralOverAxialStressWhereXAndYStand) {
  Elastic e;
  e.curve.engine = "law";
  e.curve.test = MacroTest::stages;
  using K = StageKind;
  e.curve.stages = {
      {"a", K::oedometric, K::oedometric}, {"b", K::unload, K::oedometric}, {"c", K::isotropic, K::isotropic}};
  e.add(0, {});
  for (int k = 1; k <= 4; ++k) e.add(0, {{0.0, 0.0, 0.01 * k}});
  for (int k = 1; k <= 2; ++k) e.add(1, {{0.0, 0.0, 0.04 - 0.01 * k}});
  for (int k = 1; k <= 2; ++k) e.add(2, {{0.01 * k, 0.01 * k, 0.02 + 0.01 * k}});
  const auto means = stage_means({e.curve}, "law");
  ASSERT_EQ(means.size(), 3U);
  ASSERT_TRUE(means[0].lateral_ratio.has_value());
  EXPECT_NEAR(means[0].lateral_ratio->mean, e.curve.stress_x[4] / e.curve.stress_axial[4], 1e-12);
  EXPECT_NEAR(means[1].lateral_ratio->mean, e.curve.stress_x[6] / e.curve.stress_axial[6], 1e-12);
  EXPECT_FALSE(means[2].lateral_ratio.has_value());
  EXPECT_TRUE(json_of(means[0]).contains("K0_end"));
  EXPECT_FALSE(json_of(means[2]).contains("K0_end"));
}

TEST(StageResults, NegativeTangentsAreAWarningThatSaysWhatToDo) {
  StageMeans s;
  s.record = {"reload", StageKind::reload, StageKind::oedometric};
  s.modulus_begin = MeanError{1, -3e6, 0.0, 0.0};
  s.modulus_end = MeanError{2, -2e6, 1e6, 1e6};  // not told from 0: "not determined" elsewhere
  const std::string text = negative_tangents_text(tangents_of({s}));
  EXPECT_EQ(text.find("negative tangent modulus (reload, first point: -3 MPa): "), 0U) << text;
  EXPECT_NE(text.find("take fewer steps in the stage"), std::string::npos) << text;
  s.modulus_begin->mean = 3e6;
  EXPECT_EQ(negative_tangents_text(tangents_of({s})), "");
  // Behind a peak the stress may fall.
  s.record = {"shear", StageKind::shear, StageKind::shear};
  s.modulus_end = MeanError{1, -2e6, 0.0, 0.0};
  EXPECT_EQ(negative_tangents_text(tangents_of({s})), "");
}

/// What sweeps, compare and Python read of a stage that slides.
TEST(StageResults, SummariesHoldTheShearOverNormalStress) {
  StageMeans s;
  s.record = {"slide", StageKind::direct_shear, StageKind::direct_shear};
  EXPECT_FALSE(json_of(s).contains("shear_over_normal_peak"));
  s.shear_end = MeanError{2, 0.04, 0.0, 0.0};
  s.friction_peak = MeanError{2, 0.31, 0.02, 0.01};
  s.friction_peak_shear = MeanError{2, 0.03, 0.0, 0.0};
  s.friction_end = MeanError{2, 0.25, 0.02, 0.01};
  const nlohmann::json written = json_of(s);
  EXPECT_EQ(written.at("shear_strain_end").at("mean"), 0.04);
  EXPECT_EQ(written.at("shear_over_normal_peak").at("mean"), 0.31);
  EXPECT_EQ(written.at("shear_strain_at_peak").at("mean"), 0.03);
  EXPECT_EQ(written.at("shear_over_normal_end").at("mean"), 0.25);
}

/// Reports and compare draw stresses over what drives a test, and say so.
TEST(StageResults, TestsThatSlideAreDrawnOverTheirShearStrain) {
  MacroCurve c;
  c.engine = "law";
  c.strain = {0.0, 0.02};
  c.stress_axial = {3.0, 3.0};
  for (const auto& [test, label] :
       {std::pair{MacroTest::oedometric, "axial strain [%]"}, std::pair{MacroTest::stages, "axial strain [%]"},
        std::pair{MacroTest::simple_shear, "shear strain [%]"},
        std::pair{MacroTest::direct_shear, "shear strain [%]"}}) {
    c.test = test;
    const std::vector<RunCurve> drawn = stress_curves({{"", {c}}});
    ASSERT_EQ(drawn.size(), 1U);
    EXPECT_EQ(drawn[0].x_label, label);
    EXPECT_EQ(drawn[0].x.back(), 2.0);
  }
}

TEST(StageResults, ModuliAreThoseOfHooke) {
  Elastic e;
  e.curve.engine = "law";
  e.curve.test = MacroTest::stages;
  using K = StageKind;
  e.curve.stages = {{"a", K::oedometric, K::oedometric}, {"b", K::isotropic, K::isotropic},
                    {"c", K::shear, K::shear},           {"d", K::triaxial, K::triaxial},
                    {"e", K::unload, K::triaxial},       {"f", K::hold, K::triaxial}};
  const double poisson = (3.0 * e.bulk - 2.0 * e.shear) / (2.0 * (3.0 * e.bulk + e.shear));
  const double young = 9.0 * e.bulk * e.shear / (3.0 * e.bulk + e.shear);
  Vec3 strain{};
  e.add(0, strain);
  const auto go = [&](double stage, const Vec3& step, int steps) {
    for (int k = 0; k < steps; ++k) e.add(stage, strain += step);
  };
  go(0, {{0.0, 0.0, 0.001}}, 5);
  go(1, {{0.001, 0.001, 0.001}}, 3);
  go(2, {{-0.001, 0.0, 0.001}}, 4);
  go(3, {{-poisson * 0.001, -poisson * 0.001, 0.001}}, 6);
  go(4, {{poisson * 0.001, poisson * 0.001, -0.001}}, 2);
  go(5, {}, 1);
  const auto r = stage_results(e.curve);
  ASSERT_EQ(r.size(), 6U);
  const double expected[] = {e.bulk + 4.0 / 3.0 * e.shear, e.bulk, e.shear, young, young};
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(r[k].modulus_begin, expected[k], 1e-8 * expected[k]) << k;
    EXPECT_NEAR(r[k].modulus_end, expected[k], 1e-8 * expected[k]) << k;
    EXPECT_NEAR(r[k].modulus, expected[k], 1e-8 * expected[k]) << k;
  }
  EXPECT_NEAR(r[3].poisson_begin, poisson, 1e-9);
  EXPECT_TRUE(std::isnan(r[0].poisson_begin));
  EXPECT_TRUE(std::isnan(r[5].modulus_begin));
  EXPECT_TRUE(std::isnan(r[5].modulus));
  EXPECT_NEAR(r[0].volumetric_end, -std::expm1(-0.005), 1e-12);
  EXPECT_NEAR(r[4].strain_begin, e.curve.strain_z[18], 1e-15);
  EXPECT_NEAR(r[4].strain_end, e.curve.strain_z[20], 1e-15);
}

TEST(StageResults, StrengthIsTheLargestRatio) {
  MacroCurve c;
  c.engine = "law";
  c.stages = {{"a", StageKind::triaxial, StageKind::triaxial}};
  for (int k = 0; k < 6; ++k) {
    c.stage.push_back(0);
    c.strain.push_back(0.01 * k);
    c.strain_z.push_back(0.01 * k);
    c.strain_x.push_back(-0.004 * k);
    c.strain_y.push_back(-0.004 * k);
    c.stress_x.push_back(100.0);
    c.stress_y.push_back(100.0);
  }
  c.stress_axial = {100.0, 200.0, 310.0, 400.0, 370.0, 340.0};
  const auto r = stage_results(c);
  ASSERT_EQ(r.size(), 1U);
  EXPECT_NEAR(r[0].ratio_peak, 300.0 / 200.0, 1e-12);
  EXPECT_NEAR(r[0].ratio_peak_strain, 0.03, 1e-15);
  EXPECT_NEAR(r[0].ratio_end, 240.0 / 180.0, 1e-12);
  EXPECT_NEAR(stress_ratios(c)[0], 0.0, 1e-12);
  c.stress_x[1] = 0.0;  // q of unequal stresses: sqrt(((x-y)^2 + (y-z)^2 + (z-x)^2)/2)
  EXPECT_NEAR(stress_ratios(c)[1], std::sqrt(0.5 * (1e4 + 1e4 + 4e4)) / 100.0, 1e-12);
}

/// A first step over a gap that closes: the parabola would fall, the secant does not.
TEST(StageResults, AnEndThatNoParabolaContinuesHasItsSecant) {
  MacroCurve c;
  c.engine = "law";
  c.stages = {{"a", StageKind::oedometric, StageKind::oedometric}};
  c.strain_z = c.strain = {0.0, 0.02, 0.023, 0.025};
  c.strain_x = c.strain_y = c.stage = {0.0, 0.0, 0.0, 0.0};
  c.stress_x = c.stress_y = {0.0, 0.0, 0.0, 0.0};
  c.stress_axial = {0.0, 60.0, 120.0, 180.0};
  EXPECT_NEAR(stage_results(c)[0].modulus_begin, 60.0 / -std::log1p(-0.02), 1e-9);
}

/// sigma = 1e9 eps^2 up to 0.01, and back along a steeper line.
MacroCurve stiffening(std::array<double, 2> loading = {}, std::array<double, 2> unloading = {}) {
  MacroCurve c;
  c.engine = "law";
  c.stages = {{"loading", StageKind::oedometric, StageKind::oedometric, loading},
              {"back", StageKind::unload, StageKind::oedometric, unloading}};
  const auto add = [&](double stage, double strain, double stress) {
    c.stage.push_back(stage);
    c.strain_z.push_back(-std::expm1(-strain));
    c.strain = c.strain_z;
    for (auto* none : {&c.strain_x, &c.strain_y, &c.stress_x, &c.stress_y, &c.stress_lateral, &c.stress_axial_contacts,
                       &c.coordination, &c.residual})
      none->push_back(0.0);
    c.stress_axial.push_back(stress);
  };
  for (int k = 0; k <= 100; ++k) add(0.0, 1e-4 * k, 1e9 * std::pow(1e-4 * k, 2));
  for (int k = 1; k <= 4; ++k) add(1.0, 0.01 - 2e-4 * k, 1e5 - 1e4 * k);
  return c;
}

TEST(StageResults, ModuliAreSecantsBetweenTheStressesOfTheirStage) {
  const auto usual = stage_results(stiffening());
  // From half the stress at the end, at a strain of 0.01/sqrt(2).
  EXPECT_NEAR(usual[0].modulus, 5e4 / (0.01 - 0.01 / std::sqrt(2.0)), 3e3);
  EXPECT_NEAR(usual[0].modulus_from, 5e4, 1e-6);
  EXPECT_NEAR(usual[0].modulus_to, 1e5, 1e-6);
  EXPECT_NEAR(usual[1].modulus, 1e4 / 2e-4, 1e-3);  // the whole way back
  EXPECT_NEAR(usual[1].modulus_from, 1e5, 1e-6);
  EXPECT_NEAR(usual[1].modulus_to, 6e4, 1e-6);
  const auto given = stage_results(stiffening({1e4, 4e4}, {7e4, 9e4}));
  EXPECT_NEAR(given[0].modulus, 3e4 / (std::sqrt(4e-5) - std::sqrt(1e-5)), 3e3);
  EXPECT_NEAR(given[1].modulus, 5e7, 1e-3);
  EXPECT_NEAR(given[1].modulus_from, 9e4, 1e-6);  // stress falls
  const auto far = stage_results(stiffening({1e4, 2e5}, {1e4, 9e4}));
  EXPECT_TRUE(std::isnan(far[0].modulus));
  EXPECT_TRUE(std::isnan(far[1].modulus));
}

TEST(StageResults, IntervalsAreSaidAndWhereThereIsNoModulus) {
  const auto of = [](const MacroCurve& c) { return modulus_text(stage_means({c}, "law")[0]); };
  EXPECT_NE(of(stiffening()).find(" MPa from 50 kPa to 100 kPa of axial stress (upper half of the stress)"),
            std::string::npos)
      << of(stiffening());
  EXPECT_EQ(
      of(stiffening({1e4, 2e5})),
      "constrained modulus not determined: the axial stress does not go through its interval (10 kPa to 200 kPa)");
}

/// The terminal, the summary and the report say the same of them.
TEST(StageResults, SecantsThatSamplesDoNotTellFromZeroAreNotDetermined) {
  StageMeans s;
  s.record = {"loading", StageKind::oedometric, StageKind::oedometric};
  s.modulus = MeanError{2, 468e6, 64e6, 45e6};  // Student's t of one degree: +- 572 MPa
  s.modulus_from = MeanError{2, 2.5e6, 0.0, 0.0};
  s.modulus_to = MeanError{2, 5e6, 0.0, 0.0};
  EXPECT_EQ(modulus_text(s),
            "constrained modulus not determined (468 +- 45 MPa, 2 samples) from 2.5 MPa to 5 MPa of axial stress "
            "(upper half of the stress)");
  EXPECT_EQ(json_of(s).at("not_determined"), nlohmann::json::array({"modulus_secant"}));
  s.modulus->error = 20e6;  // +- 254 MPa
  EXPECT_EQ(modulus_text(s).find("constrained modulus 468 +- 20 MPa from 2.5 MPa to 5 MPa"), 0U) << modulus_text(s);
  EXPECT_EQ(json_of(s).value("not_determined", nlohmann::json::array()).size(), 0U);
}

/// E50 of triaxial stages: up to half of the strength, whatever comes after the peak.
TEST(StageResults, YoungsModulusIsTakenToHalfOfTheStrength) {
  MacroCurve c;
  c.engine = "law";
  c.stages = {{"a", StageKind::triaxial, StageKind::triaxial}};
  for (int k = 0; k < 5; ++k) {
    c.stage.push_back(0);
    c.strain_z.push_back(-std::expm1(-0.01 * k));
    for (auto* none : {&c.strain_x, &c.strain_y}) none->push_back(0.0);
    for (auto* sides : {&c.stress_x, &c.stress_y}) sides->push_back(100.0);
  }
  c.strain = c.strain_z;
  c.stress_axial = {100.0, 200.0, 280.0, 300.0, 240.0};
  const StageResult r = stage_results(c)[0];
  EXPECT_NEAR(r.modulus, 100.0 / 0.01, 1e-6);
  EXPECT_NEAR(r.modulus_to, 200.0, 1e-9);
}

TEST(StageResults, IntervalsAreKeptWithTheirCurve) {
  const test::TemporaryDirectory directory;
  save_macro({stiffening({1e4, 4e4}), stiffening()}, directory.file("m.h5"));
  const auto back = load_macro(directory.file("m.h5"));
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0].stages[0].modulus_stress, (std::array<double, 2>{1e4, 4e4}));
  EXPECT_EQ(back[0].stages[1].modulus_stress, (std::array<double, 2>{}));
  EXPECT_EQ(back[1].stages[0].modulus_stress, (std::array<double, 2>{}));
}

TEST(StageResults, MeansLeaveOutWhatIsNotUsable) {
  Elastic e;
  e.curve.engine = "law";
  e.curve.stages = {{"a", StageKind::oedometric, StageKind::oedometric}};
  e.add(0, {});
  e.add(0, {{0.0, 0.0, 0.01}});
  MacroCurve other = e.curve;
  other.stress_axial[1] *= 2.0;
  MacroCurve bad = other;
  bad.usable = false;
  const auto m = stage_means({e.curve, other, bad}, "law");
  ASSERT_EQ(m.size(), 1U);
  EXPECT_EQ(m[0].axial_end->n, 2U);
  EXPECT_NEAR(m[0].axial_end->mean, 1.5 * e.curve.stress_axial[1], 1e-6);
  EXPECT_TRUE(stage_means({e.curve}, "shelled").empty());
  MacroCurve silent = e.curve;
  silent.stages.clear();
  EXPECT_TRUE(stage_results(silent).empty());
}

}  // namespace
}  // namespace softgrain
