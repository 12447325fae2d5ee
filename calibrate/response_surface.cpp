#include "calibrate/response_surface.h"

#include <gsl/gsl_linalg.h>

#include <algorithm>
#include <cmath>

#include "calibrate/least_squares.h"
#include "common/core/error.h"

namespace softgrain {

namespace {

/// 1, u_a, u_a u_b (a <= b); centred, so that the ridge pulls towards flat about the middle of the box.
std::vector<double> basis(const std::vector<double>& u) {
  std::vector<double> out{1.0};
  for (const double x : u) out.push_back(x - 0.5);
  for (std::size_t a = 0; a < u.size(); ++a)
    for (std::size_t b = a; b < u.size(); ++b) out.push_back((u[a] - 0.5) * (u[b] - 0.5));
  return out;
}

/// Solves A X = B for several right-hand sides in place; A is symmetric and positive definite (Cholesky).
void solve(std::vector<double>& matrix, std::vector<double>& right, std::size_t n, std::size_t columns) {
  gsl_matrix_view a = gsl_matrix_view_array(matrix.data(), n, n);
  gsl_linalg_cholesky_decomp1(&a.matrix);
  for (std::size_t j = 0; j < columns; ++j) {
    gsl_vector_view x = gsl_vector_view_array_with_stride(right.data() + j, columns, n);
    gsl_linalg_cholesky_svx(&a.matrix, &x.vector);
  }
}

}  // namespace

ResponseSurface::ResponseSurface(const std::vector<std::vector<double>>& points,
                                 const std::vector<std::vector<double>>& values, const std::vector<double>& weights,
                                 double ridge)
    : dimensions_(points.empty() ? 0 : points.front().size()), quantities_(values.empty() ? 0 : values.front().size()) {
  if (points.size() != values.size() || points.size() != weights.size() || dimensions_ == 0)
    throw InputError("response surface: points, values and weights do not go together");
  const std::size_t n = coefficients(dimensions_);
  std::vector<double> normal(n * n, 0.0);
  coefficient_.assign(n * quantities_, 0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(weights[i] > 0.0)) continue;
    const std::vector<double> row = basis(points[i]);
    for (std::size_t a = 0; a < n; ++a) {
      const double wa = weights[i] * row[a];
      for (std::size_t b = 0; b < n; ++b) normal[a * n + b] += wa * row[b];
      for (std::size_t j = 0; j < quantities_; ++j) coefficient_[a * quantities_ + j] += wa * values[i][j];
    }
  }
  if (!(normal[0] > 0.0)) throw InputError("response surface: no point to fit it to");
  for (std::size_t a = 1; a < n; ++a) normal[a * n + a] += ridge * normal[0];
  solve(normal, coefficient_, n, quantities_);
}

std::vector<double> ResponseSurface::value(const std::vector<double>& u) const {
  const std::vector<double> row = basis(u);
  std::vector<double> out(quantities_, 0.0);
  for (std::size_t a = 0; a < row.size(); ++a)
    for (std::size_t j = 0; j < quantities_; ++j) out[j] += row[a] * coefficient_[a * quantities_ + j];
  return out;
}

std::vector<double> ResponseSurface::gradient(const std::vector<double>& u) const {
  const std::size_t d = dimensions_;
  std::vector<double> out(quantities_ * d, 0.0);
  const auto add = [&](std::size_t coefficient, std::size_t direction, double slope) {
    for (std::size_t j = 0; j < quantities_; ++j)
      out[j * d + direction] += slope * coefficient_[coefficient * quantities_ + j];
  };
  for (std::size_t a = 0; a < d; ++a) add(1 + a, a, 1.0);
  std::size_t next = 1 + d;
  for (std::size_t a = 0; a < d; ++a)
    for (std::size_t b = a; b < d; ++b, ++next) {
      add(next, a, u[b] - 0.5);
      add(next, b, u[a] - 0.5);
    }
  return out;
}

SurfaceMinimum nearest_to(const ResponseSurface& surface, const std::vector<double>& target,
                          const std::vector<double>& error, const std::vector<std::vector<double>>& starts) {
  const std::size_t d = surface.dimensions();
  LeastSquaresProblem problem;
  // A weak pull towards the middle keeps directions that the target says nothing about from running away.
  constexpr double kPull = 1e-3;
  problem.residuals = target.size() + d;
  problem.bounds.assign(d, {0.0, 1.0});
  problem.evaluate = [&](std::span<const double> p, std::span<double> r) {
    const std::vector<double> z = surface.value({p.begin(), p.end()});
    for (std::size_t j = 0; j < z.size(); ++j) r[j] = (z[j] - target[j]) / error[j];
    for (std::size_t a = 0; a < d; ++a) r[z.size() + a] = kPull * (p[a] - 0.5);
    return true;
  };
  problem.jacobian = [&](std::span<const double> p, std::span<double> jacobian) {
    const std::vector<double> g = surface.gradient({p.begin(), p.end()});
    std::fill(jacobian.begin(), jacobian.end(), 0.0);
    for (std::size_t j = 0; j < target.size(); ++j)
      for (std::size_t a = 0; a < d; ++a) jacobian[j * d + a] = g[j * d + a] / error[j];
    for (std::size_t a = 0; a < d; ++a) jacobian[(target.size() + a) * d + a] = kPull;
    return true;
  };
  LeastSquaresOptions options;
  options.thorough = false;
  options.scale_covariance = false;
  options.max_iterations = 200;
  const LeastSquaresFit fit = fit_least_squares(problem, starts, options);
  SurfaceMinimum out;
  out.u = fit.parameters;
  out.chi2 = fit.residual_sum_of_squares;
  out.covariance = fit.covariance;
  out.converged = fit.end == FitEnd::converged || fit.end == FitEnd::stalled;
  return out;
}

}  // namespace softgrain
