// Nonlinear conjugate gradient with a block preconditioner.
#include <algorithm>
#include <cmath>

#include "common/statics/block_jacobi.h"
#include "common/statics/minimiser.h"

namespace softgrain::statics {

namespace {

constexpr double kFloor = 1e-2;    // of the block preconditioner
constexpr double kMaxMove = 0.05;  // of the radius, per iteration
constexpr int kRestart = 40;
constexpr int kSearchPasses = 8;

/// One run of the conjugate gradient: the state, its forces, and the search direction.
class Descent {
 public:
  Descent(PackProblem& problem, Unknowns& theta) : problem_(problem), theta_(theta) {
    problem_.evaluate(theta_, forces_);
  }
  [[nodiscard]] const PackForces& forces() const { return forces_; }

  void precondition() {
    problem_.linearise(theta_, tangents_);
    inverse_.build(problem_, tangents_, kFloor);
    direction_.clear();
  }

  /// Polak-Ribiere+ in the metric of the preconditioner.
  void choose_direction() {
    inverse_.apply(forces_.force, scaled_);
    const double gain = dot(forces_.force, scaled_);
    double beta = 0.0;
    if (!direction_.empty()) beta = std::max(0.0, (gain - dot(previous_force_, scaled_)) / gain_);
    gain_ = gain;
    if (direction_.empty()) direction_.assign(scaled_.size(), 0.0);
    for (std::size_t k = 0; k < scaled_.size(); ++k) direction_[k] = scaled_[k] + beta * direction_[k];
    if (dot(forces_.force, direction_) <= 0.0) direction_ = scaled_;
    previous_force_ = forces_.force;
  }

  /// Goes along the direction until its force has fallen well below the first (secant steps). False when it cannot.
  bool search() {
    const double first = dot(forces_.force, direction_);
    if (!(first > 0.0)) return false;
    const GrainPack& pack = problem_.pack();
    const double most = step_within(direction_, pack, problem_.stride(), kMaxMove);
    const Unknowns start = theta_;
    double low = 0.0;
    double low_force = first;
    double high = 0.0;  // 0: not bracketed
    double step = std::min(most, step_);
    for (int k = 0; k < kSearchPasses; ++k) {
      theta_ = start;
      add_scaled(theta_, step, direction_);
      problem_.evaluate(theta_, forces_);
      const double along = dot(forces_.force, direction_);
      if (!std::isfinite(along)) return false;
      if (std::abs(along) <= 0.3 * first || (along > 0.0 && step >= most)) break;
      if (along < 0.0) {
        high = step;
        step = low + (high - low) * std::clamp(low_force / (low_force - along), 0.05, 0.95);
      } else {
        const double slope = (low_force - along) / (step - low);
        const double wanted = slope > 0.0 ? step + along / slope : 4.0 * step;
        low = step;
        low_force = along;
        step = high > 0.0 ? std::clamp(wanted, low + 0.05 * (high - low), low + 0.95 * (high - low))
                          : std::min({most, wanted, 4.0 * step});
      }
    }
    step_ = std::max(step, 1e-3);
    return true;
  }

 private:
  PackProblem& problem_;
  Unknowns& theta_;
  PackForces forces_;
  std::vector<LinkTangent> tangents_;
  BlockJacobi inverse_;
  Unknowns scaled_;
  Unknowns direction_;
  Unknowns previous_force_;
  double gain_ = 0.0;
  double step_ = 1.0;
};

}  // namespace

LeastWorkResult minimise_fast(PackProblem& problem, Unknowns& theta, const LeastWorkOptions& options) {
  LeastWorkResult result;
  const Scales scales = scales_of(problem.pack(), options);
  problem.set_walls(1.0);
  theta = affine_guess(problem, 1.0);
  Descent descent(problem, theta);
  result.stopped_by = "cap";
  for (; result.iterations < options.max_iterations; ++result.iterations) {
    result.worst_residual =
        worst_residual(descent.forces(), problem.pack(), problem.stride(), residual_floor(scales, descent.forces()));
    if (!std::isfinite(result.worst_residual)) {
      result.stopped_by = "not finite";
      break;
    }
    if (result.worst_residual <= options.residual_tolerance) {
      result.stopped_by = "residual";
      result.converged = true;
      break;
    }
    if (result.iterations % kRestart == 0) descent.precondition();
    descent.choose_direction();
    if (!descent.search()) {
      result.stopped_by = "no descent";
      break;
    }
  }
  result.residual_energy = dot(descent.forces().force, descent.forces().force);
  result.work = descent.forces().work;
  return result;
}

}  // namespace softgrain::statics
