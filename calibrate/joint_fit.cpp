#include "calibrate/threshold_model.h"

#include <algorithm>
#include <cmath>

namespace softgrain {

namespace {

/// The best A and the remaining sum of squares at a given threshold and exponent, where A is linear.
std::pair<double, double> best_scale(const FitCurve& curve, JointParameters p, std::size_t j, double exponent) {
  p.exponent[j] = exponent;
  p.scale[j] = 1.0;
  double py = 0.0;
  double pp = 0.0;
  double yy = 0.0;
  for (std::size_t k = 0; k < curve.means.delta.size(); ++k) {
    const double w = mean_weight(curve, k);
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
  out.erase(std::unique(out.begin(), out.end(), [limit](double a, double b) { return b - a < 1e-9 * limit; }),
            out.end());
  return out;
}

/// A joint problem with its intervals, ready to be solved in any of them.
class IntervalFits {
 public:
  IntervalFits(const FitCurves& curves, double limit)
      : shape_(joint_shape(curves)),
        layout_(shape_.present),
        problem_(joint_problem(curves, shape_)),
        kinks_(kinks(curves, limit)) {
    for (const FitCurve& c : curves)
      for (const double d : c.means.delta)
        if (d > 0.0) smallest_ = std::min(smallest_, d);
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

  /// Takes a solution that was bounded to one interval and sets delta free: last digits, and a covariance that knows of
  /// delta. On a kink (possible when a mean there is negative) the slope differs from side to side and no step can
  /// vanish.
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
    return fit_least_squares(problem_, {layout_.pack(start)}, options_);
  }

  [[nodiscard]] JointFit describe(LeastSquaresFit fit) const {
    JointFit out;
    out.parameters = layout_.unpack(shape_, fit.parameters);
    const double tolerance = 1e-9 * kinks_.back();
    out.delta_at_zero = out.parameters.delta <= tolerance ||  // a limit of zero fixes the threshold there
                        !threshold_shows(out.parameters);
    if (out.delta_at_zero) out.parameters.delta = 0.0;
    out.delta_at_limit = out.parameters.delta >= kinks_.back() - tolerance;
    for (std::size_t j = 0; j < kLawCurves; ++j) {
      const double b = out.parameters.exponent[j];
      out.exponent_at_bound[j] =
          shape_.present[j] && (b <= kExponentBounds.low * (1.0 + 1e-9) || b >= kExponentBounds.high * (1.0 - 1e-9));
    }
    out.fit = std::move(fit);
    return out;
  }

  /// Whether c = -a delta^b is anything beside the force at the smallest overlap that was measured.
  [[nodiscard]] bool threshold_shows(const JointParameters& p) const {
    constexpr double kNothing = 1e-6;
    for (std::size_t j = 0; j < kLawCurves; ++j)
      if (p.present[j] && std::pow(p.delta / smallest_, p.exponent[j]) > kNothing) return true;
    return false;
  }

  /// -1, 0, +1: the solution sits on the lower end of interval k, inside, on the upper end.
  [[nodiscard]] int side(std::size_t k, const LeastSquaresFit& fit) const {
    const double slack = 1e-7 * (kinks_[k + 1] - kinks_[k]);
    if (fit.parameters[0] - kinks_[k] <= slack) return -1;
    return kinks_[k + 1] - fit.parameters[0] <= slack ? 1 : 0;
  }

 private:
  JointParameters shape_;
  JointLayout layout_;
  LeastSquaresProblem problem_;
  std::vector<double> kinks_;
  double smallest_ = std::numeric_limits<double>::infinity();  ///< measured overlap
  LeastSquaresOptions options_;
};

}  // namespace

JointFit fit_joint(const FitCurves& curves, double delta_limit) {
  IntervalFits fits(curves, delta_limit);
  LeastSquaresFit best;
  int iterations = 0;
  for (std::size_t k = 0; k < fits.intervals(); ++k) {
    LeastSquaresFit fit = fits.solve(k, start_at(curves, fits.shape(), fits.middle(k)));
    iterations += fit.iterations;
    // On a kink two intervals meet with equal sums; the one that sees its true slope there reports convergence.
    const bool tie =
        best.end != FitEnd::not_run &&
        std::abs(fit.residual_sum_of_squares - best.residual_sum_of_squares) <= 1e-9 * best.residual_sum_of_squares;
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

}  // namespace softgrain
