#include "calibrate/threshold_model.h"

#include <algorithm>
#include <cmath>

namespace softgrain {

namespace {

/// Where each parameter of each curve sits in the vector of the fit: delta first, then (A, b) per present curve.
struct Layout {
  std::array<std::size_t, kLawCurves> first{};
  std::size_t size = 1;

  explicit Layout(const std::array<bool, kLawCurves>& present) {
    for (std::size_t j = 0; j < kLawCurves; ++j) {
      if (!present[j]) continue;
      first[j] = size;
      size += 2;
    }
  }
};

/// x^b and its derivative over b, with the limits at x = 0.
double power(double x, double b) { return x > 0.0 ? std::pow(x, b) : 0.0; }
double power_log(double x, double b) { return x > 0.0 ? std::pow(x, b) * std::log(x) : 0.0; }

/// d F_j / d (delta, A, b) at one Delta; zero below the threshold.
std::array<double, 3> gradient(const JointParameters& p, std::size_t j, double overlap_ratio) {
  if (overlap_ratio <= p.delta) return {};
  const double u = overlap_ratio / p.reference[j];
  const double v = p.delta / p.reference[j];
  const double b = p.exponent[j];
  const double at_threshold = std::max(v, 1e-12);  // keeps the slope finite for b < 1 at delta = 0
  return {-p.scale[j] * b * std::pow(at_threshold, b - 1.0) / p.reference[j], power(u, b) - power(v, b),
          p.scale[j] * (power_log(u, b) - power_log(v, b))};
}

JointParameters unpack(const JointParameters& shape, const Layout& layout, std::span<const double> x) {
  JointParameters p = shape;
  p.delta = x[0];
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    if (!p.present[j]) continue;
    p.scale[j] = x[layout.first[j]];
    p.exponent[j] = x[layout.first[j] + 1];
  }
  return p;
}

std::vector<double> pack(const JointParameters& p, const Layout& layout) {
  std::vector<double> x(layout.size);
  x[0] = p.delta;
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    if (!p.present[j]) continue;
    x[layout.first[j]] = p.scale[j];
    x[layout.first[j] + 1] = p.exponent[j];
  }
  return x;
}

double weight(const FitCurve& curve, std::size_t k) { return std::sqrt(curve.means.count[k]) / curve.sigma[k]; }

LeastSquaresProblem make_problem(const FitCurves& curves, const JointParameters& shape, const Layout& layout) {
  LeastSquaresProblem problem;
  for (const FitCurve& c : curves) problem.residuals += c.means.delta.size();
  problem.evaluate = [&curves, shape, layout](std::span<const double> x, std::span<double> r) {
    const JointParameters p = unpack(shape, layout, x);
    std::size_t row = 0;
    for (std::size_t j = 0; j < kLawCurves; ++j)
      for (std::size_t k = 0; k < curves[j].means.delta.size(); ++k)
        r[row++] = weight(curves[j], k) * (p.value(j, curves[j].means.delta[k]) - curves[j].means.mean[k]);
    return true;
  };
  problem.jacobian = [&curves, shape, layout](std::span<const double> x, std::span<double> jacobian) {
    const JointParameters p = unpack(shape, layout, x);
    std::fill(jacobian.begin(), jacobian.end(), 0.0);
    std::size_t row = 0;
    for (std::size_t j = 0; j < kLawCurves; ++j) {
      for (std::size_t k = 0; k < curves[j].means.delta.size(); ++k, row += layout.size) {
        const auto g = gradient(p, j, curves[j].means.delta[k]);
        const double w = weight(curves[j], k);
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

JointParameters shape_of(const FitCurves& curves) {
  JointParameters p;
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    p.present[j] = curves[j].present();
    p.reference[j] = p.present[j] ? curves[j].means.delta.back() : 1.0;
  }
  return p;
}

/// For a given threshold and exponent A is linear: the best A and the remaining sum of squares.
std::pair<double, double> best_scale(const FitCurve& curve, JointParameters p, std::size_t j, double exponent) {
  p.exponent[j] = exponent;
  p.scale[j] = 1.0;
  double py = 0.0;
  double pp = 0.0;
  double yy = 0.0;
  for (std::size_t k = 0; k < curve.means.delta.size(); ++k) {
    const double w = weight(curve, k);
    const double shape = w * p.value(j, curve.means.delta[k]);
    const double y = w * curve.means.mean[k];
    py += shape * y;
    pp += shape * shape;
    yy += y * y;
  }
  const double a = pp > 0.0 ? std::max(py / pp, 0.0) : 0.0;
  return {a, yy - a * (2.0 * py - a * pp)};
}

/// Start values at a given threshold: the best of a few exponents.
JointParameters start_at(const FitCurves& curves, JointParameters p, double delta) {
  p.delta = delta;
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    if (!p.present[j]) continue;
    double least = std::numeric_limits<double>::infinity();
    JointParameters at = p;
    for (const double b : {0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 9.0}) {
      const auto [a, sum] = best_scale(curves[j], at, j, b);
      if (!(sum < least)) continue;
      least = sum;
      p.scale[j] = a > 0.0 ? a : 1e-12;
      p.exponent[j] = b;
    }
  }
  return p;
}

/// Ends of the intervals in which the residual is smooth in delta: 0, every measured Delta below the limit, the limit.
std::vector<double> kinks(const FitCurves& curves, double limit) {
  std::vector<double> out{0.0, limit};
  if (limit <= 0.0) return out;
  for (const FitCurve& c : curves)
    for (const double d : c.means.delta)
      if (d > 0.0 && d < limit) out.push_back(d);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end(), [limit](double a, double b) { return b - a < 1e-9 * limit; }), out.end());
  return out;
}

/// A joint problem with its intervals, ready to be solved in any of them.
class IntervalFits {
 public:
  IntervalFits(const FitCurves& curves, double limit)
      : shape_(shape_of(curves)), layout_(shape_.present), problem_(make_problem(curves, shape_, layout_)), kinks_(kinks(curves, limit)) {
    options_.scale_covariance = false;
    options_.thorough = false;
    options_.max_iterations = 200;
  }

  [[nodiscard]] std::size_t intervals() const { return kinks_.size() - 1; }
  [[nodiscard]] double middle(std::size_t k) const { return 0.5 * (kinks_[k] + kinks_[k + 1]); }
  [[nodiscard]] const JointParameters& shape() const { return shape_; }

  [[nodiscard]] std::size_t interval_of(double delta) const {
    const auto it = std::upper_bound(kinks_.begin(), kinks_.end(), delta);
    const auto k = static_cast<std::size_t>(std::max<std::ptrdiff_t>(it - kinks_.begin() - 1, 0));
    return std::min(k, intervals() - 1);
  }

  /// Takes a solution that was bounded to one interval and sets delta free: last digits, and a covariance that knows of delta.
  /// On a kink (possible when a mean there is negative) the slope differs from side to side and no step can vanish.
  LeastSquaresFit release(const LeastSquaresFit& bounded) {
    problem_.bounds[0] = {0.0, kinks_.back()};
    LeastSquaresFit free = fit_least_squares(problem_, {bounded.parameters}, options_);
    if (free.end != FitEnd::converged && bounded.end == FitEnd::converged) {
      free.end = FitEnd::converged;
      free.message = "converged with delta on a measured Delta, where the residual has a kink";
    }
    return free;
  }

  /// Smooth fit with delta kept inside interval k.
  LeastSquaresFit solve(std::size_t k, JointParameters start) {
    problem_.bounds[0] = {kinks_[k], kinks_[k + 1]};
    start.delta = std::clamp(start.delta, kinks_[k], kinks_[k + 1]);
    return fit_least_squares(problem_, {pack(start, layout_)}, options_);
  }

  [[nodiscard]] JointFit describe(LeastSquaresFit fit) const {
    JointFit out;
    out.parameters = unpack(shape_, layout_, fit.parameters);
    const double tolerance = 1e-9 * kinks_.back();
    out.delta_at_zero = out.parameters.delta <= tolerance;  // a limit of zero fixes the threshold there
    out.delta_at_limit = out.parameters.delta >= kinks_.back() - tolerance;
    for (std::size_t j = 0; j < kLawCurves; ++j) {
      const double b = out.parameters.exponent[j];
      out.exponent_at_bound[j] = shape_.present[j] && (b <= kExponentBounds.low * (1.0 + 1e-9) || b >= kExponentBounds.high * (1.0 - 1e-9));
    }
    out.fit = std::move(fit);
    return out;
  }

  /// -1, 0, +1: the solution sits on the lower end of interval k, inside, on the upper end.
  [[nodiscard]] int side(std::size_t k, const LeastSquaresFit& fit) const {
    const double slack = 1e-7 * (kinks_[k + 1] - kinks_[k]);
    if (fit.parameters[0] - kinks_[k] <= slack) return -1;
    return kinks_[k + 1] - fit.parameters[0] <= slack ? 1 : 0;
  }

 private:
  JointParameters shape_;
  Layout layout_;
  LeastSquaresProblem problem_;
  std::vector<double> kinks_;
  LeastSquaresOptions options_;
};

}  // namespace

double JointParameters::value(std::size_t curve, double overlap_ratio) const {
  if (overlap_ratio <= delta) return 0.0;
  const double b = exponent[curve];
  return scale[curve] * (power(overlap_ratio / reference[curve], b) - power(delta / reference[curve], b));
}

std::array<double, 7> JointParameters::law_parameters() const {
  std::array<double, 7> out{};
  constexpr std::array<std::size_t, kLawCurves> kFirst{0, 3, 5};
  out[2] = delta;
  for (std::size_t j = 0; j < kLawCurves; ++j) {
    if (!present[j]) continue;
    out[kFirst[j]] = scale[j] * std::pow(reference[j], -exponent[j]);
    out[kFirst[j] + 1] = exponent[j];
  }
  return out;
}

JointFit fit_joint(const FitCurves& curves, double delta_limit) {
  IntervalFits fits(curves, delta_limit);
  LeastSquaresFit best;
  int iterations = 0;
  for (std::size_t k = 0; k < fits.intervals(); ++k) {
    LeastSquaresFit fit = fits.solve(k, start_at(curves, fits.shape(), fits.middle(k)));
    iterations += fit.iterations;
    // On a kink two intervals meet with equal sums; the one that sees its true slope there reports convergence.
    const bool tie = best.end != FitEnd::not_run && std::abs(fit.residual_sum_of_squares - best.residual_sum_of_squares) <= 1e-9 * best.residual_sum_of_squares;
    const bool better = tie ? fit.end == FitEnd::converged && best.end != FitEnd::converged
                            : fit.residual_sum_of_squares < best.residual_sum_of_squares;
    if (better) best = std::move(fit);
  }
  best = fits.release(best);
  best.iterations += iterations;
  return fits.describe(std::move(best));
}

JointFit refit_joint(const FitCurves& curves, double delta_limit, const JointParameters& from) {
  IntervalFits fits(curves, delta_limit);
  std::size_t k = fits.interval_of(from.delta);
  LeastSquaresFit best = fits.solve(k, from);
  for (std::size_t steps = 0; steps < fits.intervals(); ++steps) {
    const int side = fits.side(k, best);
    if (side == 0 || (side < 0 && k == 0) || (side > 0 && k + 1 == fits.intervals())) break;
    k = side < 0 ? k - 1 : k + 1;
    JointParameters start = fits.describe(best).parameters;
    start.delta = 0.5 * (start.delta + fits.middle(k));
    LeastSquaresFit next = fits.solve(k, start);
    if (!(next.residual_sum_of_squares < best.residual_sum_of_squares)) break;
    best = std::move(next);
  }
  return fits.describe(std::move(best));
}

std::vector<double> packing_covariance(const JointFit& joint, const FitCurves& curves,
                                       const std::array<const CurveSamples*, kLawCurves>& samples) {
  const JointParameters& p = joint.parameters;
  const Layout layout(p.present);
  const std::size_t n = layout.size;
  const std::size_t packings = samples[0]->packings;
  const std::vector<double>& inverse = joint.fit.covariance;
  // Influence of each packing on the parameters: H^-1 s_g; their scatter is the covariance.
  constexpr std::array<std::size_t, kLawCurves> kFirst{0, 3, 5};
  std::vector<double> out(49, 0.0);
  if (packings < 2) return out;
  for (std::size_t g = 0; g < packings; ++g) {
    std::vector<double> score(n, 0.0);
    for (std::size_t j = 0; j < kLawCurves; ++j) {
      for (std::size_t k = 0; p.present[j] && k < samples[j]->delta.size(); ++k) {
        const double y = samples[j]->at(g, k);
        if (std::isnan(y)) continue;
        const auto slope = gradient(p, j, samples[j]->delta[k]);
        const double pull = (y - p.value(j, samples[j]->delta[k])) / (curves[j].sigma[k] * curves[j].sigma[k]);
        score[0] += slope[0] * pull;
        score[layout.first[j]] += slope[1] * pull;
        score[layout.first[j] + 1] += slope[2] * pull;
      }
    }
    std::vector<double> influence(n, 0.0);
    for (std::size_t r = 0; r < n; ++r)
      for (std::size_t c = 0; c < n; ++c) influence[r] += inverse[r * n + c] * score[c];
    std::array<double, 7> law{};
    law[2] = influence[0];
    for (std::size_t j = 0; j < kLawCurves; ++j) {
      if (!p.present[j]) continue;
      const double unit = std::pow(p.reference[j], -p.exponent[j]);  // a = A D_j^-b
      law[kFirst[j]] = unit * (influence[layout.first[j]] - p.scale[j] * std::log(p.reference[j]) * influence[layout.first[j] + 1]);
      law[kFirst[j] + 1] = influence[layout.first[j] + 1];
    }
    const double correction = static_cast<double>(packings) / (static_cast<double>(packings) - 1.0);
    for (std::size_t r = 0; r < 7; ++r)
      for (std::size_t c = 0; c < 7; ++c) out[r * 7 + c] += correction * law[r] * law[c];
  }
  return out;
}

}  // namespace softgrain
