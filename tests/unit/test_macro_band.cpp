// Error bars of macro curves: parts in quadrature, the mean over samples, what of a twin lies inside.
#include <gtest/gtest.h>

#include <cmath>

#include "common/data/macro_band.h"
#include "pipelines/compare/compare.h"
#include "pipelines/compare/macro_scores.h"
#include "pipelines/kinds/macro/bands.h"

namespace softgrain {
namespace {

MacroCurve curve(const std::string& engine, std::int64_t sample, std::vector<double> stress) {
  MacroCurve c;
  c.engine = engine;
  c.sample = sample;
  c.stress_axial = std::move(stress);
  for (std::size_t k = 0; k < c.stress_axial.size(); ++k) c.strain.push_back(0.1 * static_cast<double>(k));
  c.stress_lateral = c.stress_axial;
  return c;
}

/// Half-widths as shares of the stress.
void give_bands(MacroCurve& c, double law, double discrepancy) {
  const auto about = [&](double half) {
    MacroBand band;
    for (const double s : c.stress_axial) {
      band.low.push_back(s * (1.0 - half));
      band.high.push_back(s * (1.0 + half));
    }
    return band;
  };
  for (const BandOf of : {BandOf::axial, BandOf::lateral}) {
    set_band(c, of, BandPart::law, about(law));
    set_band(c, of, BandPart::discrepancy, about(discrepancy));
    set_band(c, of, BandPart::all, together(c.stress_axial, {about(law), about(discrepancy)}));
  }
}

TEST(MacroBand, PartsAddInQuadratureOnEitherSide) {
  const std::vector<double> stress{0.0, 10.0};
  const MacroBand a{{0.0, 7.0}, {0.0, 12.0}};
  const MacroBand b{{0.0, 6.0}, {1.0, 10.0}};
  const MacroBand all = together(stress, {a, b});
  EXPECT_EQ(all.low[1], 5.0);
  EXPECT_EQ(all.high[1], 12.0);
  EXPECT_EQ(all.high[0], 1.0);
  EXPECT_EQ(together(stress, {{{0.0, -20.0}, {0.0, 10.0}}}).low[1], 0.0) << "compression of grains has no other sign";
}

/// A law card has no configurations that its fit did not see: nothing is known, which is not 0.
TEST(MacroBand, AnUnknownDiscrepancyIsNoBandOfNoWidth) {
  MacroCurve c = curve("law", 0, {0.0, 100.0});
  const MacroBand law{{0.0, 97.0}, {0.0, 103.0}};
  for (const BandOf of : {BandOf::axial, BandOf::lateral}) {
    set_band(c, of, BandPart::law, law);
    set_band(c, of, BandPart::all, together(c.stress_axial, {law}));
  }
  const auto ends = banded_ends({c});
  ASSERT_EQ(ends.size(), 2U);
  EXPECT_NEAR(ends[0].law, 3.0, 1e-12);
  EXPECT_TRUE(std::isnan(ends[0].discrepancy));
  EXPECT_NEAR(ends[0].high, 103.0, 1e-12);
  EXPECT_NE(banded_text(ends[0]).find("discrepancy unknown"), std::string::npos) << banded_text(ends[0]);
}

/// Where a test ends with a stage that slides, z stands still and its strain says nothing.
TEST(MacroBand, AnEndThatSlidesHasItsShearStrain) {
  MacroCurve c = curve("law", 0, {0.0, 80.0, 100.0});
  c.test = MacroTest::stages;
  c.stages = {{"a", StageKind::oedometric, StageKind::oedometric},
              {"b", StageKind::simple_shear, StageKind::simple_shear}};
  c.stage = {0.0, 0.0, 1.0};
  c.stress_xz = {0.0, 0.0, 20.0};
  c.shear_strain = {0.0, 0.0, 0.05};
  give_bands(c, 0.03, 0.04);
  EXPECT_EQ(banded_ends({c})[0].strain, 0.05);
  EXPECT_NE(banded_text(banded_ends({c})[0]).find("axial stress at shear strain 0.05: 100 Pa"), std::string::npos)
      << banded_text(banded_ends({c})[0]);
  c.stages[1] = {"b", StageKind::oedometric, StageKind::oedometric};
  EXPECT_NE(banded_text(banded_ends({c})[0]).find("axial stress at strain 0.2: 100 Pa"), std::string::npos);
}

TEST(MacroBand, TheMeanOverSamplesHasTheIntervalOfStudent) {
  std::vector<MacroCurve> curves{curve("law", 0, {0.0, 90.0}), curve("law", 1, {0.0, 110.0}),
                                 curve("shelled", 0, {0.0, 100.0})};
  EXPECT_TRUE(banded_ends(curves).empty()) << "no bands";
  BandRecord record;
  record.engine = "law";
  const auto missing = missing_bands({record}, {});
  ASSERT_EQ(missing.size(), 1U) << "a band that was asked for is missing";
  EXPECT_TRUE(missing[0].starts_with("law has no interval")) << missing[0];
  for (int k = 0; k < 2; ++k) give_bands(curves[static_cast<std::size_t>(k)], 0.03, 0.04);
  const auto ends = banded_ends(curves);
  ASSERT_EQ(ends.size(), 2U) << "axial and lateral";
  EXPECT_TRUE(missing_bands({record}, ends).empty());
  EXPECT_EQ(ends[0].stress, 100.0);
  EXPECT_NEAR(ends[0].law, 3.0, 1e-12);
  EXPECT_NEAR(ends[0].discrepancy, 4.0, 1e-12);
  EXPECT_NEAR(ends[0].samples, 12.7062 * 10.0, 1e-2) << "t of one degree of freedom, standard error 10";
  EXPECT_FALSE(ends[0].determined) << "its error is larger than itself";
  EXPECT_TRUE(std::isnan(ends[0].low) && std::isnan(ends[0].high));
  EXPECT_NE(banded_text(ends[0]).find("100 Pa, not determined"), std::string::npos) << banded_text(ends[0]);
  std::vector<MacroCurve> more = curves;
  for (std::int64_t k = 2; k < 6; ++k) {
    more.push_back(curve("law", k, {0.0, k % 2 == 0 ? 90.0 : 110.0}));
    give_bands(more.back(), 0.03, 0.04);
  }
  const BandedEnd known = banded_ends(more)[0];
  EXPECT_TRUE(known.determined);
  EXPECT_EQ(known.count, 6);
  EXPECT_NEAR(known.high, 100.0 + std::hypot(3.0, 4.0, 2.570582 * std::sqrt(120.0 / 6.0)), 1e-2);
  EXPECT_NEAR(known.high - known.stress, known.stress - known.low, 1e-9);
  EXPECT_EQ(banded_text(known).find("beyond"), std::string::npos);
  more[1].law_evaluations = {100.0, 100.0};
  more[1].law_beyond = {0.0, 7.0};
  EXPECT_NE(banded_text(banded_ends(more)[0]).find("at least: 7 % of the contacts are beyond"), std::string::npos);
  curves.erase(curves.begin());
  EXPECT_TRUE(std::isnan(banded_ends(curves)[0].samples));
  EXPECT_NE(banded_text(banded_ends(curves)[0]).find("unknown: one alone"), std::string::npos);
}

TEST(MacroBand, ScoresSayWhatOfTheTwinLiesInside) {
  MacroCurve law = curve("law", 0, {0.0, 100.0, 200.0, 300.0});
  give_bands(law, 0.03, 0.04);  // together 5 %
  // The first point bears less than 5 % of the last, the second lies outside, the end inside.
  const MacroCurve twin = curve("shelled", 0, {1.0, 110.0, 205.0, 290.0});
  const auto scores = score_engines({law, twin});
  EXPECT_NEAR(scores[0].coverage.mean, 2.0 / 3.0, 1e-12);
  EXPECT_EQ(scores[0].coverage_end.mean, 1.0);
  EXPECT_NEAR(scores[0].band_width.mean, 0.05, 1e-12);
  EXPECT_EQ(scores[1].coverage.n, 0U) << "a twin has no band";
  const Comparison compared = compare_curves({law}, {twin});
  EXPECT_NEAR(compared.in_band.mean, 2.0 / 3.0, 1e-12);
  EXPECT_EQ(compared.end_in_band.mean, 1.0);
  EXPECT_NEAR(compared.band_width.mean, 0.05, 1e-12);
  EXPECT_EQ(compare_curves({twin}, {law}).in_band.n, 0U);
  // A twin of other points is taken between them.
  MacroCurve finer = curve("shelled", 0, {0.0, 0.0, 0.0});
  finer.strain = {0.0, 0.25, 0.3};
  finer.stress_axial = {0.0, 250.0, 300.0};
  EXPECT_EQ(share_in_band(law, finer, false), 1.0);
  finer.stress_axial = {0.0, 250.0, 340.0};
  EXPECT_EQ(share_in_band(law, finer, true), 0.0);
}

TEST(MacroBand, ScoresKnowNoisePlacesAndTheErrorOfTheMean) {
  std::vector<MacroCurve> curves;
  for (std::int64_t k = 0; k < 4; ++k) {
    const double off = k % 2 == 0 ? 1.2 : 0.8;  // samples cancel in the mean
    curves.push_back(curve("directional", k, {0.0, 100.0 * off, 200.0 * off}));
    curves.push_back(curve("shelled", k, {0.0, 100.0, 200.0}));
  }
  curves[0].more[kAgainAxial] = {0.0, 1.1 * 120.0, 1.1 * 240.0};
  curves[0].law.form = LawForm::directional;
  curves[0].cost.contact_evaluations = 50;
  for (MacroCurve& c : curves) {
    if (c.engine != "shelled") continue;
    c.more["places_shelled_solid"] = {0.0, 10.0, 30.0};
    c.more["places_directional_solid"] = {0.0, 14.0, 34.0};
  }
  const EngineScore s = score_engines(curves)[0];
  EXPECT_NEAR(s.shelled.axial.mean, 0.2, 1e-12);
  EXPECT_NEAR(s.shelled.axial_of_mean.mean, 0.0, 1e-12);
  EXPECT_NEAR(s.shelled.axial_of_mean.error, 0.2 / std::sqrt(3.0), 1e-12) << "of four differences of 0.2";
  EXPECT_NEAR(s.noise.mean, 0.1 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(s.places.solid.mean, 1.2, 1e-12);
  EXPECT_EQ(s.places.wall.n, 0U);
  EXPECT_NEAR(s.contact_evaluations, 2.0 * 50.0 / 4.0, 1e-12) << "a multi-contact law visits a contact twice";
}

TEST(MacroBand, WhatAFormIsOffByComesFromWhatItHasNotSeen) {
  MultiContactLaw law;
  law.error_cross = 0.2;
  EXPECT_EQ(form_discrepancy(law), 0.2) << "nothing was held out";
  law.errors = {{"fitted", MultiContactUse::fitted, 0.5, 1.0, 0.0},
                {"a", MultiContactUse::predicted, 0.10, 1.0, 0.06},
                {"b", MultiContactUse::predicted, 0.05, 1.0, 0.03}};
  const double pressed = std::sqrt(0.5 * (0.08 * 0.08 + 0.04 * 0.04));
  EXPECT_NEAR(form_discrepancy(law), pressed, 1e-12);
  law.errors.push_back({"sheared", MultiContactUse::predicted, 0.13, 1.0, 0.05, 10, {}, false});
  EXPECT_NEAR(form_discrepancy(law), 0.12, 1e-12) << "a scene may be all shear";
  law.errors.back().error = 0.05;
  EXPECT_NEAR(form_discrepancy(law), pressed, 1e-12) << "or none";
}

TEST(MacroBand, AFormIsOffInItsForcesAndInItsOnset) {
  MultiContactLaw law;
  law.errors = {{"a", MultiContactUse::predicted, 0.10, 1.0, 0.06}};
  ASSERT_EQ(form_offsets(law).size(), 1U) << "an earlier table does not say them";
  EXPECT_NEAR(form_offsets(law)[0].force, 0.08, 1e-12);
  EXPECT_EQ(form_offsets(law)[0].onset, 0.0);
  law.errors = {{"a", MultiContactUse::predicted, 0.1, 1.0, 0.03, 10, FormOffset{0.2, -0.010}},
                {"b", MultiContactUse::predicted, 0.1, 1.0, 0.04, 10, FormOffset{-0.1, 0.020}},
                {"seen", MultiContactUse::fitted, 0.1, 1.0, 0.0, 10, FormOffset{9.0, 9.0}}};
  const std::vector<FormOffset> ways = form_offsets(law);
  ASSERT_EQ(ways.size(), 2U);
  EXPECT_NEAR(ways[0].force, form_discrepancy(law), 1e-12);
  EXPECT_EQ(ways[0].onset, 0.0);
  EXPECT_EQ(ways[1].force, 0.0);
  EXPECT_NEAR(ways[1].onset, std::sqrt(0.5 * (1e-4 + 4e-4)), 1e-12);
}

}  // namespace
}  // namespace softgrain
