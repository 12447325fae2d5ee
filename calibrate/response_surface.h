// A quadratic surface through noisy results at scattered points, one for each of several quantities, and where it comes
// nearest to a target.
#pragma once

#include <cstddef>
#include <vector>

namespace softgrain {

/// z_j(u) = c_j0 + sum_a c_ja u_a + sum_{a<=b} c_jab u_a u_b, by weighted least squares.
class ResponseSurface {
 public:
  /// Share of the weight of all points that keeps the normal equations solvable, of points all over the box.
  static constexpr double kRidge = 1e-6;

  /// `points` in [0, 1]^d, `values` one row of quantities per point, `weights` one per point (0: left out). With fewer
  /// points of weight than coefficients, or points that lie badly, a small ridge keeps the surface flat where nothing
  /// is known. Points within a distance w of each other tell of curvature by w^4: `ridge` must be small beside that.
  /// Throws InputError when sizes do not agree or no point has weight.
  ResponseSurface(const std::vector<std::vector<double>>& points, const std::vector<std::vector<double>>& values,
                  const std::vector<double>& weights, double ridge = kRidge);

  [[nodiscard]] std::size_t dimensions() const { return dimensions_; }
  [[nodiscard]] std::size_t quantities() const { return quantities_; }
  /// Number of coefficients per quantity: (d + 1)(d + 2)/2.
  static std::size_t coefficients(std::size_t dimensions) { return (dimensions + 1) * (dimensions + 2) / 2; }

  [[nodiscard]] std::vector<double> value(const std::vector<double>& u) const;
  /// dz_j/du_a, row-major (quantities x dimensions).
  [[nodiscard]] std::vector<double> gradient(const std::vector<double>& u) const;

 private:
  std::size_t dimensions_;
  std::size_t quantities_;
  std::vector<double> coefficient_;  ///< coefficients x quantities, row-major
};

/// Where a surface comes nearest to a target.
struct SurfaceMinimum {
  std::vector<double> u;
  double chi2 = 0.0;
  std::vector<double> covariance;  ///< d x d of u from the curvature of chi2 there; of directions inside the box only
  bool converged = false;
};

/// Minimises chi2 = sum_j ((z_j(u) - target_j)/error_j)^2 over the unit box, from every start (at least one).
SurfaceMinimum nearest_to(const ResponseSurface& surface, const std::vector<double>& target,
                          const std::vector<double>& error, const std::vector<std::vector<double>>& starts);

}  // namespace softgrain
