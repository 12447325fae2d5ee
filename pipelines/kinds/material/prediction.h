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
  visit("measured", v.measured, kLeftOut, Means{"measured mean, where a variant has that span"});
}

struct PredictedPoint {
  double strain = 0.0;
  PredictedValue pressure, axial, lateral;  ///< stresses over E; not where the volume is held
  PredictedValue deviator;
  bool beyond = false;
};

void fields(auto&& visit, Of<PredictedPoint> auto& p) {
  visit("strain", p.strain, Means{"axial strain", "1"});
  visit("p", p.pressure, Means{"pressure over E", "1"});
  visit("axial", p.axial, Means{"axial stress over E", "1"});
  visit("lateral", p.lateral, Means{"lateral stress over E", "1"});
  visit("q_over_p", p.deviator, Means{"q/p", "1"});
  visit("beyond_fit", p.beyond, Means{"pressure above all that the equation of state was fitted to"});
}

/// Prediction for one family under one loading, at one span.
struct PredictionSummary {
  std::string family;
  std::string loading;
  StageKind kind = StageKind::oedometric;
  double span = 0.0;
  double largest_fitted = 0.0;
  bool usable = false;
  std::string message{};
  std::optional<Estimate> solid_fraction{};
  int samples_measured = 0;
  std::vector<PredictedPoint> points{};
};

void fields(auto&& visit, Of<PredictionSummary> auto& s) {
  visit("family", s.family, Means{"materials that differ in the span alone"});
  visit("loading", s.loading, Means{"loading; empty: the scene has one test"});
  visit("stage", s.kind, Means{"kind of the stage"});
  visit("span", s.span, Means{"largest over smallest radius", "1"});
  visit("largest_fitted_span", s.largest_fitted, Means{"largest span that was used", "1"});
  visit("usable", s.usable, Means{"whether there is a prediction"});
  visit("message", s.message, Means{"the forms of onset, or why there is none"});
  visit("solid_fraction_start", s.solid_fraction, kLeftOut, Means{"solid fraction at the start pressure", "1"});
  visit("samples_measured", s.samples_measured, Means{"samples of a variant with that span", "1"});
  visit("points", s.points, kLeftOut, Means{"points of the test"});
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
