// Which variants and loadings of a scene go into a prediction, and what is set beside it.
#include <gtest/gtest.h>

#include <cmath>

#include "calibrate/state_curves.h"
#include "common/core/random.h"
#include "macrosim/body_contacts.h"
#include "pipelines/kinds/material/prediction.h"

namespace softgrain {
namespace {

constexpr double kYoung = 5e5;
constexpr double kStart = 1e-4;

double onset_of(double span) { return 1.0 / (1.0 + 0.75 * std::exp(-0.3 * (std::hypot(std::log(span), 1.0) - 1.0))); }

/// A sample that follows K = 0.05, n = 1.8 and K0 = 0.5; sheared, it keeps its pressure.
MacroCurve curve_of(StageKind kind, double span, double start_pressure, RandomStream& random) {
  const double onset = onset_of(span) + 5e-4 * random.normal();
  const double start = state_phi(StateForm::porosity, 0.05, 1.8, onset, start_pressure);
  MacroCurve c;
  c.usable = true;
  c.start.youngs_modulus = kYoung;
  c.stages = {{"test", kind, kind}};
  for (int k = 0; k < 9; ++k) {
    const double strain = 0.01 * k;
    const double phi = kind == StageKind::shear ? start : start / (1.0 - strain);
    const double p = kYoung * state_pressure(StateForm::porosity, 0.05, 1.8, onset, phi);
    c.stage.push_back(0);
    c.strain.push_back(strain);
    c.strain_x.push_back(0.0);
    c.strain_y.push_back(0.0);
    c.strain_z.push_back(strain);
    c.stress_axial.push_back(1.5 * p);
    c.stress_x.push_back(0.75 * p);
    c.stress_y.push_back(0.75 * p);
    c.stress_lateral.push_back(0.75 * p);
    c.stress_deviator.push_back(0.75 * p);
    c.more[kSolidFraction].push_back(phi);
  }
  return c;
}

std::vector<PredictionInput> inputs_of(const std::vector<double>& spans, double start = kStart) {
  RandomStream random(1, RandomPurpose::bootstrap, 5);
  std::vector<PredictionInput> out;
  for (const double span : spans)
    for (const auto& [loading, kind] : {std::pair{"shear", StageKind::shear}, {"pressed", StageKind::oedometric}}) {
      PredictionInput in{"m" + std::to_string(span), span, "family", loading, "", 0.0, start, {}};
      for (int s = 0; s < 3; ++s) in.curves.push_back(curve_of(kind, span, start, random));
      out.push_back(std::move(in));
    }
  return out;
}

EquationSettings settings() { return {.largest_span = 6.0, .spans = {12.0, 50.0}, .replicates = 60}; }

EquationSettings quick_settings() { return {.largest_span = 6.0, .spans = {12.0}, .replicates = 40}; }

const PredictionSummary* find(const std::vector<PredictionSummary>& all, const std::string& loading, double span) {
  for (const PredictionSummary& s : all)
    if (s.loading == loading && s.span == span) return &s;
  return nullptr;
}

TEST(SpanPredictions, EveryLoadingIsPredictedAndMeasuredSpansStandBeside) {
  const auto found = predict_spans(inputs_of({1.5, 2.4, 4.0, 6.0, 12.0}), settings(), 1);
  ASSERT_EQ(found.size(), 4U);
  const PredictionSummary* pressed = find(found, "pressed", 12.0);
  const PredictionSummary* sheared = find(found, "shear", 12.0);
  const PredictionSummary* unknown = find(found, "pressed", 50.0);
  ASSERT_TRUE(pressed != nullptr && sheared != nullptr && unknown != nullptr);
  ASSERT_TRUE(pressed->usable && sheared->usable) << pressed->message << sheared->message;
  EXPECT_EQ(pressed->largest_fitted, 6.0);
  EXPECT_EQ(pressed->samples_measured, 3);
  EXPECT_EQ(unknown->samples_measured, 0);
  const PredictedPoint& at = point_near(*pressed, 0.0504);
  EXPECT_EQ(at.strain, 0.05);
  ASSERT_TRUE(at.axial.measured);
  EXPECT_TRUE(at.axial.inside()) << at.axial.predicted.low << " " << at.axial.measured->mean;
  EXPECT_NEAR(at.axial.predicted.value / at.axial.measured->mean, 1.0, 0.1);
  EXPECT_NEAR(at.lateral.measured->mean / at.axial.measured->mean, 0.5, 1e-12);
  EXPECT_NEAR(point_near(*sheared, 0.05).deviator.predicted.value, 0.75, 1e-9);
  EXPECT_FALSE(point_near(*unknown, 0.05).axial.measured);
  EXPECT_TRUE(point_near(*unknown, 0.08).beyond);
  EXPECT_FALSE(point_near(*unknown, 0.0).beyond);
  const std::string text = prediction_text(found);
  EXPECT_NE(text.find("measured"), std::string::npos);
  EXPECT_NE(text.find("inside"), std::string::npos);
  EXPECT_NE(text.find("beyond the pressures that were fitted"), std::string::npos);
}

/// The truth at span 60 narrows what is said of 1000, and one that is wrong moves it.
TEST(SpanPredictions, OnsetsThatWereMeasuredElsewhereTakePart) {
  const auto inputs = inputs_of({1.5, 2.4, 4.0, 6.0});
  EquationSettings s{.largest_span = 6.0, .spans = {1000.0}, .replicates = 60};
  const auto alone = predict_spans(inputs, s, 1);
  s.onsets = {{60.0, onset_of(60.0), 1e-3}};
  const auto with = predict_spans(inputs, s, 1);
  s.onsets.front().value -= 0.01;
  const auto wrong = predict_spans(inputs, s, 1);
  const auto at = [](const auto& found) { return find(found, "pressed", 1000.0); };
  ASSERT_TRUE(at(alone)->usable && at(with)->usable && at(wrong)->usable) << at(with)->message;
  EXPECT_EQ(at(alone)->largest_fitted, 6.0);
  EXPECT_EQ(at(with)->largest_fitted, 60.0);
  const Estimate& wide = *at(alone)->solid_fraction;
  const Estimate& narrow = *at(with)->solid_fraction;
  EXPECT_LT(narrow.high - narrow.low, 0.3 * (wide.high - wide.low));
  const double truth = state_phi(StateForm::porosity, 0.05, 1.8, onset_of(1000.0), kStart);
  EXPECT_LT(narrow.low, truth);
  EXPECT_GT(narrow.high, truth);
  EXPECT_LT(at(wrong)->solid_fraction->value, narrow.value - 0.005);
}

TEST(SpanPredictions, OnsetsThatWereMeasuredElsewhereAreSaid) {
  std::vector<EquationInput> inputs;
  for (const PredictionInput& in : inputs_of({1.5, 2.4, 6.0}))
    if (in.loading == "pressed") inputs.push_back({in.material, in.span, in.family, in.curves, 0.0});
  EquationSettings s = quick_settings();
  s.onsets = {{60.0, onset_of(60.0), 1e-3}};
  const std::optional<EquationResult> found = equation_of(inputs, s, 1);
  ASSERT_TRUE(found && found->summary.usable);
  EXPECT_EQ(found->summary.onsets.size(), 3U);
  ASSERT_EQ(found->summary.known.size(), 1U);
  EXPECT_EQ(found->summary.known.front().span, 60.0);
  ASSERT_EQ(found->summary.extrapolations.size(), 1U);
  EXPECT_EQ(found->summary.extrapolations.front().largest_fitted, 60.0);
}

/// Who asks for a span and gets nothing is warned, once for all spans with one reason.
TEST(SpanPredictions, WhatIsNotExtrapolatedIsAWarning) {
  EquationSummary s;
  const Estimate found{0.7, 0.01, 0.68, 0.72};
  s.extrapolations = {{"fast", 12.0, 6.0, true, "rods", found, {}, {}},
                      {"fast", 50.0, 6.0, false, "all forms are refused by the data", {}, {}, {}},
                      {"fast", 200.0, 6.0, false, "all forms are refused by the data", {}, {}, {}}};
  const std::vector<std::string> said = extrapolation_warnings(s);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said.front(), "phi_J of fast is not extrapolated to span 50, 200: all forms are refused by the data");
  s.known = {{60.0, 0.9, 1e-4}};
  EXPECT_NE(extrapolation_warnings(s).at(0).find("[[equation.onset]]"), std::string::npos);
  for (ExtrapolationSummary& e : s.extrapolations) e.usable = true;
  EXPECT_TRUE(extrapolation_warnings(s).empty());
}

TEST(SpanPredictions, VariantsAboveTheLargestSpanChangeNothing) {
  auto inputs = inputs_of({1.5, 2.4, 4.0, 6.0, 12.0});
  const auto before = predict_spans(inputs, settings(), 1);
  for (PredictionInput& in : inputs)
    if (in.span > 6.0)
      for (MacroCurve& c : in.curves)
        for (auto* stress : {&c.stress_axial, &c.stress_x, &c.stress_y})
          for (double& s : *stress) s *= 3.0;
  const auto after = predict_spans(inputs, settings(), 1);
  const PredictedValue a = point_near(*find(before, "pressed", 12.0), 0.05).axial;
  const PredictedValue b = point_near(*find(after, "pressed", 12.0), 0.05).axial;
  EXPECT_EQ(a.predicted.value, b.predicted.value);
  EXPECT_EQ(a.predicted.low, b.predicted.low);
  EXPECT_NEAR(b.measured->mean / a.measured->mean, 3.0, 1e-9);
  EXPECT_FALSE(b.inside());
}

/// The variant that comes first is in no fit, and has more points than those that are.
TEST(SpanPredictions, PointsAreThoseOfTheVariantsThatWereFitted) {
  auto inputs = inputs_of({12.0, 1.5, 2.4, 6.0});
  for (PredictionInput& in : inputs)
    if (in.span > 6.0)
      for (MacroCurve& c : in.curves)
        for (auto* column : {&c.strain, &c.strain_x, &c.strain_y, &c.strain_z, &c.stage, &c.stress_axial, &c.stress_x,
                             &c.stress_y, &c.more[kSolidFraction]})
          column->insert(column->end(), 300, column->back());
  const auto found = predict_spans(inputs, quick_settings(), 1);
  for (const char* loading : {"pressed", "shear"}) {
    const PredictionSummary* s = find(found, loading, 12.0);
    ASSERT_TRUE(s != nullptr && s->usable) << loading;
    ASSERT_EQ(s->points.size(), 9U) << loading;
    EXPECT_NEAR(s->points.back().strain, 0.08, 1e-12) << loading;
    EXPECT_EQ(s->samples_measured, 0) << "other points cannot stand beside: " << loading;
  }
}

TEST(SpanPredictions, AnEquationOfStateThatCannotBeFittedIsSaid) {
  auto inputs = inputs_of({1.5, 2.4, 6.0});
  for (PredictionInput& in : inputs)
    for (MacroCurve& c : in.curves)
      for (double& phi : c.more[kSolidFraction]) phi *= 1.5;  // overlaps count twice: more than 1 is found
  std::vector<PredictionSummary> found;
  ASSERT_NO_THROW(found = predict_spans(inputs, quick_settings(), 1));
  ASSERT_FALSE(found.empty());
  for (const PredictionSummary& s : found) {
    EXPECT_FALSE(s.usable);
    EXPECT_NE(s.message.find("equation of state: curve"), std::string::npos) << s.message;
  }
}

/// From a start pressure far below a hundredth of the last one.
TEST(SpanPredictions, PressureMayGrowMoreThanAHundredfold) {
  auto inputs = inputs_of({1.5, 2.4, 6.0}, 1e-5);
  EXPECT_LT(inputs[1].curves[0].stress_axial.front(), 0.01 * inputs[1].curves[0].stress_axial.back());
  const auto found = predict_spans(inputs, quick_settings(), 1);
  const PredictionSummary* s = find(found, "pressed", 12.0);
  ASSERT_TRUE(s != nullptr && s->usable);
  EXPECT_TRUE(prediction_remarks(inputs, found, quick_settings()).empty());
  inputs[1].curves[0].stress_axial.front() = inputs[1].curves[0].stress_x.front() = 0.0;
  inputs[1].curves[0].stress_y.front() = 0.0;
  const auto remarks = prediction_remarks(inputs, found, quick_settings());
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_NE(remarks[0].find("pressed: 1 of 3 samples has no part"), std::string::npos) << remarks[0];
}

/// q/p needs no pressure, and those of shear are within what was fitted to the same packings.
TEST(SpanPredictions, ShearIsNotBeyondWhatItsCompressionWasFittedTo) {
  const auto found = predict_spans(inputs_of({1.5, 2.4, 6.0}), quick_settings(), 1);
  const PredictionSummary* s = find(found, "shear", 12.0);
  ASSERT_TRUE(s != nullptr && s->usable);
  for (const PredictedPoint& p : s->points) EXPECT_FALSE(p.beyond) << p.strain;
}

/// Variants that test alike are predicted from each other alone.
TEST(SpanPredictions, TestsThatDifferAreNotJoined) {
  auto inputs = inputs_of({1.5, 2.4, 6.0});
  for (PredictionInput& in : inputs)
    if (in.span == 6.0 && in.loading == "pressed") in.test = ", test = another";
  const auto found = predict_spans(inputs, quick_settings(), 1);
  const PredictionSummary* pressed = find(found, "pressed", 12.0);
  ASSERT_NE(pressed, nullptr);
  EXPECT_LE(pressed->largest_fitted, 2.4);
  for (PredictionInput& in : inputs) in.test = ", test = " + in.material;
  const auto none = predict_spans(inputs, quick_settings(), 1);
  EXPECT_TRUE(none.empty());
  const auto remarks = prediction_remarks(inputs, none, quick_settings());
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_NE(remarks[0].find("differ in nothing else"), std::string::npos) << remarks[0];
}

TEST(SpanPredictions, OneSpanOrSeveralStagesPredictNothing) {
  EXPECT_TRUE(predict_spans(inputs_of({6.0, 12.0}), settings(), 1).empty());
  auto inputs = inputs_of({1.5, 2.4, 6.0});
  for (PredictionInput& in : inputs)
    for (MacroCurve& c : in.curves) c.stages.push_back({"back", StageKind::unload, StageKind::oedometric});
  EXPECT_TRUE(predict_spans(inputs, settings(), 1).empty());
  EXPECT_TRUE(prediction_text({}).empty());
}

}  // namespace
}  // namespace softgrain
