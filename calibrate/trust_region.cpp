#include "calibrate/trust_region.h"

#include <ceres/ceres.h>
#include <ceres/dynamic_numeric_diff_cost_function.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace softgrain {

namespace {

using Vector = std::vector<double>;

/// Residuals over scaled parameters q_j = p_j / scale_j, one parameter block.
class ScaledCost final : public ceres::CostFunction {
 public:
  ScaledCost(const LeastSquaresProblem& problem, const Vector& scale)
      : problem_(problem), scale_(scale), p_(scale.size()) {
    set_num_residuals(static_cast<int>(problem.residuals));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(scale.size()));
  }

  bool Evaluate(double const* const* q, double* residuals, double** jacobians) const override {
    const std::size_t n = scale_.size();
    for (std::size_t j = 0; j < n; ++j) p_[j] = q[0][j] * scale_[j];
    if (!problem_.evaluate(p_, {residuals, problem_.residuals})) return false;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    const std::span<double> jacobian(jacobians[0], problem_.residuals * n);
    const bool defined = jacobian_at(problem_, p_, jacobian);
    for (std::size_t k = 0; k < jacobian.size(); ++k) jacobian[k] *= scale_[k % n];
    return defined;
  }

 private:
  const LeastSquaresProblem& problem_;
  const Vector& scale_;
  mutable Vector p_;
};

/// Residuals over parameters in units of `size`, as Ceres's differences take them.
struct SizedResiduals {
  const LeastSquaresProblem& problem;
  const Vector& size;

  bool operator()(double const* const* q, double* residuals) const {
    Vector p(size);
    for (std::size_t j = 0; j < p.size(); ++j) p[j] *= q[0][j];
    return problem.evaluate(p, {residuals, problem.residuals});
  }
};

/// Central differences of one small step: a larger one meets the kinks of models with thresholds.
bool differences_at(const LeastSquaresProblem& problem, std::span<const double> p, std::span<double> jacobian) {
  Vector size(p.begin(), p.end());
  Vector q(p.size(), 1.0);
  for (std::size_t j = 0; j < p.size(); ++j)
    if (p[j] == 0.0) std::tie(size[j], q[j]) = std::pair{1.0, 0.0};
  const SizedResiduals sized{problem, size};
  ceres::NumericDiffOptions options;
  options.relative_step_size = std::cbrt(std::numeric_limits<double>::epsilon());
  ceres::DynamicNumericDiffCostFunction<SizedResiduals> cost(&sized, ceres::DO_NOT_TAKE_OWNERSHIP, options);
  cost.AddParameterBlock(static_cast<int>(p.size()));
  cost.SetNumResiduals(static_cast<int>(problem.residuals));
  Vector residuals(problem.residuals);
  const double* block = q.data();
  double* slopes = jacobian.data();
  const bool defined = cost.Evaluate(&block, residuals.data(), &slopes);
  for (std::size_t k = 0; k < jacobian.size(); ++k) jacobian[k] /= size[k % size.size()];
  return defined;
}

ceres::Solver::Options solver_options(const TrustRegionStrategy& strategy, const LeastSquaresOptions& options) {
  ceres::Solver::Options o;
  o.linear_solver_type = ceres::DENSE_QR;
  o.trust_region_strategy_type = strategy.dogleg ? ceres::DOGLEG : ceres::LEVENBERG_MARQUARDT;
  o.dogleg_type = strategy.subspace ? ceres::SUBSPACE_DOGLEG : ceres::TRADITIONAL_DOGLEG;
  o.use_nonmonotonic_steps = strategy.non_monotonic;
  o.initial_trust_region_radius = strategy.initial_radius;
  o.max_num_iterations = options.max_iterations;
  o.max_num_consecutive_invalid_steps = 60;
  o.function_tolerance = options.thorough ? 1e-18 : 1e-13;
  o.gradient_tolerance = 1e-30;
  o.parameter_tolerance = options.thorough ? 1e-16 : 1e-12;
  o.num_threads = 1;
  o.logging_type = ceres::SILENT;
  return o;
}

/// Size of each parameter: its value, or where that is zero the width of its bounds, or one.
Vector scales(const LeastSquaresProblem& problem, const Vector& p) {
  Vector scale(p.size(), 1.0);
  for (std::size_t j = 0; j < p.size(); ++j) {
    if (p[j] != 0.0) {
      scale[j] = std::abs(p[j]);
    } else if (!problem.bounds.empty()) {
      const double width = problem.bounds[j].high - problem.bounds[j].low;
      if (std::isfinite(width) && width > 0.0) scale[j] = width;
    }
  }
  return scale;
}

/// Bounds of zero width fix a parameter.
void set_bounds(ceres::Problem& ceres_problem, double* q, const LeastSquaresProblem& problem, const Vector& scale) {
  std::vector<int> fixed;
  for (std::size_t j = 0; j < problem.bounds.size(); ++j) {
    const ParameterBounds& b = problem.bounds[j];
    if (b.low == b.high) {
      fixed.push_back(static_cast<int>(j));
      continue;
    }
    if (std::isfinite(b.low)) ceres_problem.SetParameterLowerBound(q, static_cast<int>(j), b.low / scale[j]);
    if (std::isfinite(b.high)) ceres_problem.SetParameterUpperBound(q, static_cast<int>(j), b.high / scale[j]);
  }
  if (fixed.size() == scale.size())
    ceres_problem.SetParameterBlockConstant(q);
  else if (!fixed.empty())
    ceres_problem.SetManifold(q, new ceres::SubsetManifold(static_cast<int>(scale.size()), fixed));
}

/// Ceres reports unusual steps through glog; libraries of this project do not print.
void silence_glog() {
  static const bool done = [] {
    FLAGS_minloglevel = google::GLOG_FATAL;
    return true;
  }();
  (void)done;
}

}  // namespace

bool jacobian_at(const LeastSquaresProblem& problem, std::span<const double> p, std::span<double> jacobian) {
  return problem.jacobian ? problem.jacobian(p, jacobian) : differences_at(problem, p, jacobian);
}

const std::vector<TrustRegionStrategy>& trust_region_strategies() {
  static const std::vector<TrustRegionStrategy> all{
      {"Levenberg-Marquardt", false, false, false, 1.0e4},
      {"Levenberg-Marquardt, small first steps", false, false, false, 1.0},
      {"Levenberg-Marquardt, non-monotonic", false, false, true, 1.0e4},
      {"dogleg", true, false, false, 1.0},
      {"subspace dogleg", true, true, false, 1.0e2},
      {"subspace dogleg, small first steps", true, true, true, 1.0e-1},
  };
  return all;
}

TrustRegionEnd run_trust_region(const LeastSquaresProblem& problem, const std::vector<double>& start,
                                const TrustRegionStrategy& strategy, const LeastSquaresOptions& options) {
  silence_glog();
  const Vector scale = scales(problem, start);
  Vector q(start.size());
  for (std::size_t j = 0; j < q.size(); ++j) q[j] = start[j] / scale[j];
  ceres::Problem ceres_problem;
  ceres_problem.AddResidualBlock(new ScaledCost(problem, scale), nullptr, q.data());
  set_bounds(ceres_problem, q.data(), problem, scale);
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(strategy, options), &ceres_problem, &summary);
  TrustRegionEnd end;
  end.ran = !summary.iterations.empty() && std::isfinite(summary.initial_cost) && summary.initial_cost >= 0.0;
  end.capped = summary.termination_type == ceres::NO_CONVERGENCE;
  end.iterations = static_cast<int>(summary.iterations.size());
  end.message = summary.message;
  end.parameters.resize(q.size());
  for (std::size_t j = 0; j < q.size(); ++j) end.parameters[j] = q[j] * scale[j];
  for (std::size_t j = 0; j < problem.bounds.size(); ++j)
    end.parameters[j] = std::clamp(end.parameters[j], problem.bounds[j].low, problem.bounds[j].high);
  return end;
}

}  // namespace softgrain
