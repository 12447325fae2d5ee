// The published minimiser [QS 2.2]: Fletcher-Reeves conjugate gradient refreshed every k_SD iterations, one-dimensional
// minimisation with bounded moves, walls in sub-increments every k_inc iterations with the affine guess.
#include <algorithm>
#include <cmath>

#include "common/io/interrupt.h"
#include "common/statics/minimiser.h"

namespace softgrain::statics {

namespace {

/// The force along a search direction counts as gone at this share of its first value.
constexpr double kLineTolerance = 1e-2;
constexpr int kLinePasses = 30;

class FletcherReeves {
 public:
  FletcherReeves(PackProblem& problem, Unknowns& theta, double max_move)
      : problem_(problem), theta_(theta), max_move_(max_move) {
    problem_.evaluate(theta_, forces_);
  }
  [[nodiscard]] const PackForces& forces() const { return forces_; }

  /// Walls to `part`, grains by the affine guess.
  void move_walls(double from, double part) {
    problem_.set_walls(part);
    add_scaled(theta_, 1.0, affine_guess(problem_, part - from));
    problem_.evaluate(theta_, forces_);
    direction_.clear();
  }

  void iterate(bool refresh) {
    const double size2 = dot(forces_.force, forces_.force);
    if (refresh || direction_.empty() || !(last2_ > 0.0)) {
      direction_ = forces_.force;
    } else {
      const double beta = size2 / last2_;
      for (std::size_t k = 0; k < direction_.size(); ++k) direction_[k] = forces_.force[k] + beta * direction_[k];
      if (dot(forces_.force, direction_) <= 0.0) direction_ = forces_.force;
    }
    last2_ = size2;
    minimise_along();
  }

 private:
  double force_along(const Unknowns& start, double step) {
    theta_ = start;
    add_scaled(theta_, step, direction_);
    problem_.evaluate(theta_, forces_);
    return dot(forces_.force, direction_);
  }

  /// Zero of the force along the direction: the bracket grows from the last step, then false position (Illinois).
  void minimise_along() {
    const double first = dot(forces_.force, direction_);
    if (!(first > 0.0)) return;
    const double most = longest_step(direction_, problem_.pack(), problem_.stride(), max_move_);
    const Unknowns start = theta_;
    double low = 0.0, low_force = first, high = 0.0, high_force = 0.0;
    double step = std::min(most, step_ > 0.0 ? step_ : 0.1 * most);
    for (int k = 0; k < kLinePasses; ++k) {
      const double along = force_along(start, step);
      if (!std::isfinite(along)) return;
      if (std::abs(along) <= kLineTolerance * first || (along > 0.0 && step >= most)) break;
      if (along < 0.0) {
        if (high > 0.0) low_force *= 0.5;
        high = step;
        high_force = along;
      } else {
        if (high > 0.0) high_force *= 0.5;
        low = step;
        low_force = along;
      }
      step = high > 0.0 ? low + (high - low) * low_force / (low_force - high_force) : std::min(most, 2.0 * step);
    }
    step_ = step;
  }

  PackProblem& problem_;
  Unknowns& theta_;
  double max_move_;
  PackForces forces_;
  Unknowns direction_;
  double last2_ = 0.0;
  double step_ = 0.0;
};

}  // namespace

LeastWorkResult minimise_published(PackProblem& problem, Unknowns& theta, const LeastWorkOptions& options) {
  LeastWorkResult result;
  const Scales scales = scales_of(problem.pack(), options);
  const double force_stop = options.force_tolerance * problem.pack().grains() * scales.energy * scales.energy;
  FletcherReeves descent(problem, theta, options.max_move);
  const int parts = std::max(1, options.sub_increments);
  int applied = 0;
  double work = 0.0;
  bool walls_moved = false;
  for (;; ++result.iterations) {
    stop_if_interrupted("looking for equilibrium");
    walls_moved = applied < parts && result.iterations % options.sub_increment_interval == 0;
    if (walls_moved) {
      descent.move_walls(static_cast<double>(applied) / parts, static_cast<double>(applied + 1) / parts);
      ++applied;
    }
    result.residual_energy = dot(descent.forces().force, descent.forces().force);
    if (!std::isfinite(result.residual_energy)) {
      result.stopped_by = LeastWorkEnd::not_finite;
      break;
    }
    const double now = descent.forces().work - problem.reference_work();
    if (applied == parts && !walls_moved) {
      if (std::abs(work - now) < options.work_tolerance * std::abs(now)) result.stopped_by = LeastWorkEnd::work;
      if (result.residual_energy < force_stop) result.stopped_by = LeastWorkEnd::force;
      result.converged = result.stopped_by != LeastWorkEnd::cap;
      if (result.converged) break;
    }
    work = now;
    if (result.iterations >= options.max_iterations) break;
    descent.iterate(result.iterations % options.refresh == 0);
  }
  result.worst_residual =
      worst_residual(descent.forces(), problem.pack(), problem.stride(), residual_floor(scales, descent.forces()));
  result.work = descent.forces().work;
  return result;
}

}  // namespace softgrain::statics
