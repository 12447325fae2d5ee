#include <cmath>

#include "calibrate/threshold_model.h"

namespace softgrain {

namespace {

/// Gradient of half the sum of squares over the fit's parameters that one packing contributes.
std::vector<double> score_of(std::size_t packing, const JointParameters& p, const JointLayout& layout,
                             const FitCurves& curves, const std::array<const CurveSamples*, kLawCurves>& samples) {
  std::vector<double> score(layout.size, 0.0);
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    for (std::size_t k = 0; p.present[j] && k < samples[j]->delta.size(); ++k) {
      const double y = samples[j]->at(packing, k);
      if (std::isnan(y)) continue;
      const auto slope = law_gradient(p, j, samples[j]->delta[k]);
      const double pull = (y - p.value(j, samples[j]->delta[k])) / (curves[j].sigma[k] * curves[j].sigma[k]);
      score[0] += slope[0] * pull;
      score[layout.first[j]] += slope[1] * pull;
      score[layout.first[j] + 1] += slope[2] * pull;
    }
  }
  return score;
}

/// A small change of the fit's parameters as a change of (a, b, delta): a = A D_j^-b.
std::array<double, 7> as_law(const std::vector<double>& change, const JointParameters& p, const JointLayout& layout) {
  std::array<double, 7> law{};
  law[2] = change[0];
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    if (!p.present[j]) continue;
    const double unit = std::pow(p.reference[j], -p.exponent[j]);
    const double exponent = change[layout.first[j] + 1];
    law[kRowOfA[j]] = unit * (change[layout.first[j]] - p.scale[j] * std::log(p.reference[j]) * exponent);
    law[kRowOfA[j] + 1] = exponent;
  }
  return law;
}

}  // namespace

std::vector<double> packing_covariance(const JointFit& joint, const FitCurves& curves,
                                       const std::array<const CurveSamples*, kLawCurves>& samples) {
  const JointLayout layout(joint.parameters.present);
  const std::size_t packings = samples[0]->packings;
  std::vector<double> out(49, 0.0);
  if (packings < 2) return out;
  const double correction = static_cast<double>(packings) / (static_cast<double>(packings) - 1.0);
  for (std::size_t g = 0; g < packings; ++g) {
    const std::vector<double> score = score_of(g, joint.parameters, layout, curves, samples);
    std::vector<double> influence(layout.size, 0.0);
    for (std::size_t r = 0; r < layout.size; ++r)
      for (std::size_t c = 0; c < layout.size; ++c)
        influence[r] += joint.fit.covariance[r * layout.size + c] * score[c];
    const auto law = as_law(influence, joint.parameters, layout);
    for (std::size_t r = 0; r < 7; ++r)
      for (std::size_t c = 0; c < 7; ++c) out[r * 7 + c] += correction * law[r] * law[c];
  }
  return out;
}

}  // namespace softgrain
