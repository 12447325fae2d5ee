#include "calibrate/threshold_model.h"

#include <algorithm>
#include <cmath>

namespace softgrain {

namespace {

/// x^b and its derivative over b, with the limits at x = 0.
double power(double x, double b) { return x > 0.0 ? std::pow(x, b) : 0.0; }
double power_log(double x, double b) { return x > 0.0 ? std::pow(x, b) * std::log(x) : 0.0; }

}  // namespace

double JointParameters::value(std::size_t curve, double overlap_ratio) const {
  if (overlap_ratio <= delta) return 0.0;
  const double b = exponent[curve];
  return scale[curve] * (power(overlap_ratio / reference[curve], b) - power(delta / reference[curve], b));
}

std::array<double, 7> JointParameters::law_parameters() const {
  std::array<double, 7> out{};
  out[2] = delta;
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    if (!present[j]) continue;
    out[kRowOfA[j]] = scale[j] * std::pow(reference[j], -exponent[j]);
    out[kRowOfA[j] + 1] = exponent[j];
  }
  return out;
}

JointLayout::JointLayout(const std::array<bool, kLawCurves>& present) {
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    if (!present[j]) continue;
    first[j] = size;
    size += 2;
  }
}

std::vector<double> JointLayout::pack(const JointParameters& p) const {
  std::vector<double> x(size);
  x[0] = p.delta;
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    if (!p.present[j]) continue;
    x[first[j]] = p.scale[j];
    x[first[j] + 1] = p.exponent[j];
  }
  return x;
}

JointParameters JointLayout::unpack(const JointParameters& shape, std::span<const double> x) const {
  JointParameters p = shape;
  p.delta = x[0];
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    if (!p.present[j]) continue;
    p.scale[j] = x[first[j]];
    p.exponent[j] = x[first[j] + 1];
  }
  return p;
}

std::array<double, 3> law_gradient(const JointParameters& p, std::size_t j, double overlap_ratio) {
  if (overlap_ratio <= p.delta) return {};
  const double u = overlap_ratio / p.reference[j];
  const double v = p.delta / p.reference[j];
  const double b = p.exponent[j];
  const double at_threshold = std::max(v, 1e-12);  // keeps the slope finite for b < 1 at delta = 0
  return {-p.scale[j] * b * std::pow(at_threshold, b - 1.0) / p.reference[j], power(u, b) - power(v, b),
          p.scale[j] * (power_log(u, b) - power_log(v, b))};
}

LeastSquaresProblem joint_problem(const FitCurves& curves, const JointParameters& shape) {
  const JointLayout layout(shape.present);
  LeastSquaresProblem problem;
  for (const FitCurve& c : curves) problem.residuals += c.means.delta.size();
  problem.evaluate = [&curves, shape, layout](std::span<const double> x, std::span<double> r) {
    const JointParameters p = layout.unpack(shape, x);
    std::size_t row = 0;
    for (std::size_t j = 0; j < kLawCurves; ++j)
      for (std::size_t k = 0; k < curves[j].means.delta.size(); ++k)
        r[row++] = mean_weight(curves[j], k) * (p.value(j, curves[j].means.delta[k]) - curves[j].means.mean[k]);
    return true;
  };
  problem.jacobian = [&curves, shape, layout](std::span<const double> x, std::span<double> jacobian) {
    const JointParameters p = layout.unpack(shape, x);
    std::fill(jacobian.begin(), jacobian.end(), 0.0);
    std::size_t row = 0;
    for (std::size_t j = 0; j < kLawCurves; ++j) {
      for (std::size_t k = 0; k < curves[j].means.delta.size(); ++k, row += layout.size) {
        const auto g = law_gradient(p, j, curves[j].means.delta[k]);
        const double w = mean_weight(curves[j], k);
        jacobian[row] = w * g[0];
        jacobian[row + layout.first[j]] = w * g[1];
        jacobian[row + layout.first[j] + 1] = w * g[2];
      }
    }
    return true;
  };
  problem.bounds.assign(layout.size, {0.0, std::numeric_limits<double>::infinity()});
  for (std::size_t j = 0; j < kLawCurves; ++j)
    if (shape.present[j]) problem.bounds[layout.first[j] + 1] = kExponentBounds;
  return problem;
}

JointParameters joint_shape(const FitCurves& curves) {
  JointParameters p;
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    p.present[j] = curves[j].present();
    p.reference[j] = p.present[j] ? curves[j].means.delta.back() : 1.0;
  }
  return p;
}

}  // namespace softgrain
