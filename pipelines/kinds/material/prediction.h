// Responses of spans that nobody resolves, predicted from variants of smaller ones; where there is a variant of such a
// span, what it measured stands beside the prediction.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipelines/kinds/material/equation.h"

namespace softgrain {

/// A variant under one loading, as predictions see it.
struct PredictionInput {
  std::string material;  ///< name of the material, the same for all its loadings
  double span = 1.0;
  std::string family;           ///< materials that differ in the span alone
  std::string loading;          ///< empty: the scene has one test
  std::string test;             ///< what differs in the tests of this loading, as test_family() says it
  double exponent = 0.0;        ///< exponent of the power law of sizes; 0: another form
  double start_pressure = 0.0;  ///< start pressure over E
  std::vector<MacroCurve> curves;
};

/// One quantity at one point of the test. Inside: the mean of what was measured lies in the interval.
struct PredictedValue {
  Estimate predicted;
  std::optional<MeanError> measured;

  [[nodiscard]] bool inside() const { return predicted.low <= measured->mean && measured->mean <= predicted.high; }
  /// Width of the interval over the value.
  [[nodiscard]] double width() const { return (predicted.high - predicted.low) / predicted.value; }
};

void fields(auto&& visit, Of<PredictedValue> auto& v) {
  fields(visit, v.predicted);
  visit("measured", v.measured, kLeftOut);
}

struct PredictedPoint {
  double strain = 0.0;
  PredictedValue pressure, axial, lateral;  ///< stresses over E; not where the volume is held
  PredictedValue deviator;                  ///< q/p
  bool beyond = false;                      ///< pressure above all that the equation of state was fitted to
};

void fields(auto&& visit, Of<PredictedPoint> auto& p) {
  visit("strain", p.strain);
  visit("p", p.pressure);
  visit("axial", p.axial);
  visit("lateral", p.lateral);
  visit("q_over_p", p.deviator);
  visit("beyond_fit", p.beyond);
}

/// Prediction for one family under one loading, at one span.
struct PredictionSummary {
  std::string family;
  std::string loading;
  StageKind kind = StageKind::oedometric;
  double span = 0.0;
  double largest_fitted = 0.0;
  bool usable = false;
  std::string message{};  ///< the forms of onset, or why there is none
  std::optional<Estimate> solid_fraction{};
  int samples_measured = 0;
  std::vector<PredictedPoint> points{};
};

void fields(auto&& visit, Of<PredictionSummary> auto& s) {
  visit("family", s.family);
  visit("loading", s.loading);
  visit("stage", s.kind);
  visit("span", s.span);
  visit("largest_fitted_span", s.largest_fitted);
  visit("usable", s.usable);
  visit("message", s.message);
  visit("solid_fraction_start", s.solid_fraction, kLeftOut);
  visit("samples_measured", s.samples_measured);
  visit("points", s.points, kLeftOut);
}

/// Predictions for all families with two spans or more up to `largest_span`, in equal tests of one stage, at
/// `settings.spans`. The equation of state of a prediction is fitted to its test (for shear: to the first that
/// compresses the same packings) and its family alone, without larger spans. One that cannot be fitted is not usable,
/// with the reason.
std::vector<PredictionSummary> predict_spans(const std::vector<PredictionInput>& inputs,
                                             const EquationSettings& settings, std::uint64_t seed);

/// What a reader would miss: samples that have no part in predictions because their stress vanishes or changes sign at
/// a point, and why no span was predicted at all. Empty where none was asked for.
std::vector<std::string> prediction_remarks(const std::vector<PredictionInput>& inputs,
                                            const std::vector<PredictionSummary>& predictions,
                                            const EquationSettings& settings);

/// Lines for people: at strains of 2, 5 and 8 %, or the last.
std::string prediction_text(const std::vector<PredictionSummary>& predictions);

/// The point nearest to a strain.
const PredictedPoint& point_near(const PredictionSummary& prediction, double strain);

}  // namespace softgrain
