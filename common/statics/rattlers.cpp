#include "common/statics/rattlers.h"

#include <algorithm>
#include <cmath>

#include "common/statics/block_jacobi.h"

namespace softgrain::statics {

namespace {

constexpr double kLight = 10.0;        // times `least_force`: what counts as a rattler
constexpr double kOutlier = 3.0;       // of the root mean square force: grains that hold up all others
constexpr double kReduction = 0.1;     // of the force on an outlier: its neighbours change too
constexpr int kSteps = 40;             // per grain and call
constexpr int kRattlerPasses = 6;      // per step
constexpr double kRattlerMove = 0.02;  // of the radius, per step
constexpr double kFloor = 1e-3;        // of the grain's stiffness: holds what no contact holds

double size_of(const Unknowns& force) {
  double most2 = 0.0;
  for (std::size_t k = 0; k < force.size(); k += 3) most2 = std::max(most2, norm2(triple(force, k)));
  return std::sqrt(most2);
}

class Rattler {
 public:
  Rattler(PackProblem& problem, Unknowns& theta, std::size_t grain)
      : problem_(problem), theta_(theta), grain_(grain), at_(grain * static_cast<std::size_t>(problem.stride())) {
    problem_.evaluate_grain(theta_, grain_, state_);
  }

  void relax(double enough) {
    for (int k = 0; k < kSteps && size_of(state_.force) > enough; ++k)
      if (!step()) return;
  }

 private:
  bool step() {
    own_step(problem_, grain_, state_, kFloor, direction_);
    const double most = size_of(direction_);
    const double limit = kRattlerMove * problem_.pack().radius[grain_];
    if (most > limit)
      for (double& d : direction_) d *= limit / most;
    const double first = dot(state_.force, direction_);
    if (!(first > 0.0)) return false;
    start_.assign(theta_.begin() + static_cast<std::ptrdiff_t>(at_),
                  theta_.begin() + static_cast<std::ptrdiff_t>(at_ + direction_.size()));
    double part = 1.0;
    for (int k = 0; k < kRattlerPasses; ++k) {
      for (std::size_t d = 0; d < direction_.size(); ++d) theta_[at_ + d] = start_[d] + part * direction_[d];
      problem_.evaluate_grain(theta_, grain_, state_);
      const double along = dot(state_.force, direction_);
      if (along >= -0.5 * first) break;
      part *= std::clamp(first / (first - along), 0.05, 0.95);
    }
    return true;
  }

  PackProblem& problem_;
  Unknowns& theta_;
  std::size_t grain_;
  std::size_t at_;
  GrainForces state_;
  Unknowns direction_, start_;
};

}  // namespace

bool relax_rattlers(PackProblem& problem, const PackForces& forces, double least_force, double tolerance,
                    Unknowns& theta) {
  if (!problem.symmetry().empty()) return false;
  const auto stride = static_cast<std::size_t>(problem.stride());
  const std::vector<double>& weight = problem.pack().weight;
  bool any = false;
  const double rms = std::sqrt(dot(forces.force, forces.force) / static_cast<double>(forces.largest2.size()));
  Unknowns own(stride);
  for (std::size_t g = 0; g < forces.largest2.size(); ++g) {
    for (std::size_t k = 0; k < stride; ++k) own[k] = forces.force[g * stride + k];
    const double scale = std::max({least_force, std::sqrt(forces.largest2[g]), weight.empty() ? 0.0 : weight[g]});
    const double size = size_of(own);
    if (!(size > tolerance * scale)) continue;
    const bool light = scale <= kLight * least_force;
    if (!light && size < kOutlier * rms) continue;
    const double enough = 0.1 * tolerance * scale;
    Rattler(problem, theta, g).relax(light ? enough : std::max(enough, kReduction * size));
    any = true;
  }
  return any;
}

}  // namespace softgrain::statics
