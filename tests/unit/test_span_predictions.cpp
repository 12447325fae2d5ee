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
MacroCurve curve_of(StageKind kind, double span, RandomStream& random) {
  const double onset = onset_of(span) + 5e-4 * random.normal();
  const double start = state_phi(StateForm::porosity, 0.05, 1.8, onset, kStart);
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

std::vector<PredictionInput> inputs_of(const std::vector<double>& spans) {
  RandomStream random(1, RandomPurpose::bootstrap, 5);
  std::vector<PredictionInput> out;
  for (const double span : spans)
    for (const auto& [loading, kind] : {std::pair{"shear", StageKind::shear}, {"pressed", StageKind::oedometric}}) {
      PredictionInput in{"m" + std::to_string(span), span, "family", loading, 0.0, kStart, {}};
      for (int s = 0; s < 3; ++s) in.curves.push_back(curve_of(kind, span, random));
      out.push_back(std::move(in));
    }
  return out;
}

EquationSettings settings() { return {.largest_span = 6.0, .spans = {12.0, 50.0}, .replicates = 60}; }

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
