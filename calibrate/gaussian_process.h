// Gaussian process regression of few noisy values over few variables: a linear trend and a smooth remainder.
#pragma once

#include <cstddef>
#include <vector>

namespace softgrain {

/// Mean and standard deviation of a normal distribution.
struct ProcessValue {
  double mean = 0.0;
  double deviation = 0.0;
};

/// z(u) = c0 + sum_a c_a u_a + g(u) + e, with vague priors on c, g of covariance A exp(-sum_a (u_a - v_a)^2/(2 l_a^2))
/// and e independent from point to point, of variance error^2 + s^2: the measured errors and a scatter s of the points
/// themselves. A, l_a and s maximise the marginal likelihood times wide log-normal priors (Rasmussen and Williams 2006,
/// Gaussian Processes for Machine Learning, ISBN 026218253X, eqs. 2.25, 2.26, 5.8; trend: section 2.7). Variables are
/// best scaled to [0, 1].
class GaussianProcess {
 public:
  /// One row of `points` per value; `errors`: standard errors of the values, at least 0. Throws InputError when sizes
  /// do not agree, a number is not finite, there are fewer values than least_values(), or their covariance has no
  /// Cholesky decomposition, as of points far from [0, 1].
  GaussianProcess(std::vector<std::vector<double>> points, std::vector<double> values, std::vector<double> errors);

  /// Values that it needs: two more than the trend has coefficients.
  static std::size_t least_values(std::size_t variables) { return variables + 3; }

  /// What another point would have: its deviation holds the scatter s, not the error of a measurement there.
  [[nodiscard]] ProcessValue at(const std::vector<double>& u) const;

  /// As if a point had been measured with this standard error, and what is expected there had been found: deviations
  /// around it narrow, means stay, and so do A, l_a and s. Throws InputError for other coordinates and errors below 0.
  void expect(const std::vector<double>& u, double error);

  [[nodiscard]] double scatter() const;                      ///< s
  [[nodiscard]] const std::vector<double>& lengths() const;  ///< l_a

 private:
  struct Shape {
    double amplitude = 1.0;       ///< A^(1/2) over the deviation of the values
    std::vector<double> lengths;  ///< l_a
    double scatter = 0.1;         ///< s over the deviation of the values
  };
  [[nodiscard]] double covariance(const Shape& shape, const std::vector<double>& u, const std::vector<double>& v) const;
  /// Covariance of the values over their variance, row-major.
  [[nodiscard]] std::vector<double> matrix(const Shape& shape) const;
  /// Minus the logarithm of likelihood times prior.
  [[nodiscard]] double cost(const Shape& shape) const;
  [[nodiscard]] Shape shape_of(const std::vector<double>& logarithms) const;
  void fit();
  void solve();

  std::vector<std::vector<double>> points_;
  std::vector<double> values_;  ///< less their mean, over their deviation
  std::vector<double> errors_;  ///< over the deviation of the values
  double mean_ = 0.0;
  double unit_ = 1.0;  ///< deviation of the values
  Shape shape_;
  std::vector<double> inverse_;  ///< of the covariance of the values, row-major
  std::vector<double> pull_;     ///< inverse times values
};

/// What the others say of each value: a process of these alone, with A, l_a and s fitted to them. Deviations as of
/// GaussianProcess::at(). In parallel; the same for any number of threads. Throws InputError as GaussianProcess does;
/// it needs one value more.
std::vector<ProcessValue> leave_one_out(const std::vector<std::vector<double>>& points,
                                        const std::vector<double>& values, const std::vector<double>& errors);

/// Distance of a point from the convex hull of others, in their units: min |sum_k w_k x_k - u| with w >= 0, sum w = 1,
/// by non-negative least squares (Lawson and Hanson 1995, doi:10.1137/1.9781611971217, ch. 23). 0 inside.
double distance_from_hull(const std::vector<std::vector<double>>& points, const std::vector<double>& u);

}  // namespace softgrain
