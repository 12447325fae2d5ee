
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <memory>

#include "calibrate/trust_region.h"

namespace softgrain {

namespace {

using Vector = std::vector<double>;

struct FreeMatrix {
  void operator()(gsl_matrix* m) const { gsl_matrix_free(m); }
  void operator()(gsl_vector* v) const { gsl_vector_free(v); }
};
using MatrixPtr = std::unique_ptr<gsl_matrix, FreeMatrix>;
using VectorPtr = std::unique_ptr<gsl_vector, FreeMatrix>;

bool all_finite(const Vector& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

bool evaluate_jacobian(const LeastSquaresProblem& problem, const Vector& p, Vector& jacobian) {
  return jacobian_at(problem, p, jacobian) && all_finite(jacobian);
}

/// Parameters on a bound (to rounding) with the descent direction pointing out of it. A parameter without effect on the
/// residuals is not held by its bound, but undetermined.
std::vector<bool> active_bounds(const LeastSquaresProblem& problem, const Vector& p, const Vector& r,
                                const Vector& jacobian) {
  std::vector<bool> active(p.size(), false);
  for (std::size_t j = 0; j < problem.bounds.size(); ++j) {
    const ParameterBounds& b = problem.bounds[j];
    const double slack = 1e-9 * std::max(std::abs(p[j]), std::isfinite(b.high - b.low) ? b.high - b.low : 0.0);
    double gradient = 0.0;
    bool felt = false;
    for (std::size_t i = 0; i < r.size(); ++i) {
      gradient += jacobian[i * p.size() + j] * r[i];
      felt = felt || jacobian[i * p.size() + j] != 0.0;
    }
    if (!felt && b.low < b.high) continue;
    active[j] = (p[j] - b.low <= slack && gradient >= 0.0) || (b.high - p[j] <= slack && gradient <= 0.0);
  }
  return active;
}

/// GSL ends the program on an error unless told not to; here a status is enough.
void keep_gsl_from_aborting() {
  static const auto previous = gsl_set_error_handler_off();
  (void)previous;
}

/// Singular value decomposition of the free columns, each divided by its norm: J_free = Q U S V^T diag(norm), Q from a
/// QR decomposition, which leaves a small square to the one-sided Jacobi that keeps small singular values accurate.
/// Rows of zeros are added when there are fewer residuals than columns.
struct Decomposition {
  std::vector<std::size_t> free;  ///< column of each free parameter
  Vector norm;
  MatrixPtr u, v;
  VectorPtr s;
  std::size_t rank = 0;
  Vector turned;  ///< Q^T r, what lies in the columns
};

Decomposition decompose(const Vector& jacobian, const Vector& r, const std::vector<bool>& at_bound, double tolerance) {
  Decomposition d;
  const std::size_t n = at_bound.size();
  const std::size_t rows = r.size();
  for (std::size_t j = 0; j < n; ++j)
    if (!at_bound[j]) d.free.push_back(j);
  const std::size_t columns = d.free.size();
  if (columns == 0) return d;
  const auto height = static_cast<Eigen::Index>(std::max(rows, columns));
  const auto width = static_cast<Eigen::Index>(columns);
  Eigen::MatrixXd scaled = Eigen::MatrixXd::Zero(height, width);
  d.v.reset(gsl_matrix_alloc(columns, columns));
  d.s.reset(gsl_vector_alloc(columns));
  for (std::size_t c = 0; c < columns; ++c) {
    double sum = 0.0;
    for (std::size_t i = 0; i < rows; ++i) sum += jacobian[i * n + d.free[c]] * jacobian[i * n + d.free[c]];
    d.norm.push_back(std::sqrt(sum));
    for (std::size_t i = 0; i < rows && sum > 0.0; ++i)
      scaled(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)) = jacobian[i * n + d.free[c]] / d.norm[c];
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(scaled);
  Eigen::VectorXd turned = Eigen::VectorXd::Zero(height);
  for (std::size_t i = 0; i < rows; ++i) turned[static_cast<Eigen::Index>(i)] = r[i];
  turned.applyOnTheLeft(qr.householderQ().adjoint());
  d.turned.assign(turned.data(), turned.data() + columns);
  d.u.reset(gsl_matrix_calloc(columns, columns));
  for (std::size_t i = 0; i < columns; ++i)
    for (std::size_t c = i; c < columns; ++c)
      gsl_matrix_set(d.u.get(), i, c, qr.matrixQR()(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)));
  keep_gsl_from_aborting();
  gsl_linalg_SV_decomp_jacobi(d.u.get(), d.v.get(), d.s.get());
  const double smallest = tolerance * gsl_vector_get(d.s.get(), 0);
  while (d.rank < columns && gsl_vector_get(d.s.get(), d.rank) > smallest) ++d.rank;
  return d;
}

/// Step and inverse over the free parameters; directions beyond the rank take no part.
void fill_free(const Decomposition& d, Linearisation& out) {
  const std::size_t n = out.at_bound.size();
  const std::size_t columns = d.free.size();
  Vector seen(columns, 0.0);  // share of each parameter's axis inside the determined directions
  for (std::size_t k = 0; k < d.rank; ++k) {
    Vector direction(columns);
    double along = 0.0;
    for (std::size_t i = 0; i < columns; ++i) along += gsl_matrix_get(d.u.get(), i, k) * d.turned[i];
    for (std::size_t c = 0; c < columns; ++c) {
      const double v = gsl_matrix_get(d.v.get(), c, k);
      seen[c] += v * v;
      direction[c] = d.norm[c] > 0.0 ? v / (gsl_vector_get(d.s.get(), k) * d.norm[c]) : 0.0;
    }
    for (std::size_t c = 0; c < columns; ++c) {
      out.step[d.free[c]] -= direction[c] * along;
      for (std::size_t e = 0; e < columns; ++e) out.inverse[d.free[c] * n + d.free[e]] += direction[c] * direction[e];
    }
  }
  for (std::size_t c = 0; c < columns; ++c) out.undetermined[d.free[c]] = d.norm[c] == 0.0 || seen[c] < 1.0 - 1e-8;
}

Linearisation undefined(std::size_t parameters) {
  Linearisation out;
  out.step.assign(parameters, 0.0);
  out.inverse.assign(parameters * parameters, 0.0);
  out.undetermined.assign(parameters, false);
  out.at_bound.assign(parameters, false);
  return out;
}

}  // namespace

Linearisation linearise(const LeastSquaresProblem& problem, const std::vector<double>& p, double rank_tolerance) {
  Vector r(problem.residuals);
  Vector jacobian(problem.residuals * p.size());
  const bool defined = problem.evaluate(p, r) && all_finite(r) && evaluate_jacobian(problem, p, jacobian);
  return defined ? linearised(problem, p, r, jacobian, rank_tolerance) : undefined(p.size());
}

Linearisation linearised(const LeastSquaresProblem& problem, const std::vector<double>& p, const std::vector<double>& r,
                         const std::vector<double>& jacobian, double rank_tolerance) {
  Linearisation out = undefined(p.size());
  out.defined = true;
  for (const double x : r) out.residual_sum_of_squares += x * x;
  out.at_bound = active_bounds(problem, p, r, jacobian);
  const Decomposition d = decompose(jacobian, r, out.at_bound, rank_tolerance);
  out.rank = static_cast<int>(d.rank);
  out.rank_deficient = d.rank < d.free.size();
  fill_free(d, out);
  return out;
}

double step_in_deviations(const Linearisation& at, const std::vector<double>& p, std::size_t residuals) {
  const std::size_t n = p.size();
  const double freedom = std::max(1.0, static_cast<double>(residuals) - static_cast<double>(n));
  const double s = std::sqrt(at.residual_sum_of_squares / freedom);
  double largest = 0.0;
  for (std::size_t j = 0; j < n; ++j) {
    if (std::abs(at.step[j]) <= 1e-10 * std::abs(p[j])) continue;
    const double deviation = s * std::sqrt(at.inverse[j * n + j]);
    largest = std::max(largest, deviation > 0.0 ? std::abs(at.step[j]) / deviation : HUGE_VAL);
  }
  return largest;
}

void polish(const LeastSquaresProblem& problem, std::vector<double>& p, double rank_tolerance) {
  constexpr int kMaxSteps = 12;
  Linearisation here = linearise(problem, p, rank_tolerance);
  for (int k = 0; k < kMaxSteps && here.defined && !here.rank_deficient; ++k) {
    const double left = step_in_deviations(here, p, problem.residuals);
    if (left <= 1e-12) return;
    std::vector<double> next = p;
    for (std::size_t j = 0; j < p.size(); ++j) next[j] += here.step[j];
    for (std::size_t j = 0; j < problem.bounds.size(); ++j)
      next[j] = std::clamp(next[j], problem.bounds[j].low, problem.bounds[j].high);
    const Linearisation there = linearise(problem, next, rank_tolerance);
    const bool smaller_step = step_in_deviations(there, next, problem.residuals) < left;
    // S carries the rounding of the residuals; the step does not, so it decides when S stands still.
    const bool better =
        there.defined &&
        (there.residual_sum_of_squares < here.residual_sum_of_squares ||
         (smaller_step && there.residual_sum_of_squares <= here.residual_sum_of_squares * (1.0 + 1e-9)));
    if (!better) return;
    p = std::move(next);
    here = there;
  }
}

}  // namespace softgrain
