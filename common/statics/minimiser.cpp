#include "common/statics/minimiser.h"

#include <algorithm>
#include <cmath>

#include "common/core/limits.h"
#include "common/statics/stiffness.h"

namespace softgrain::statics {

namespace {

/// Share of the mean contact force under which a grain counts as a rattler in the residual.
constexpr double kRattlerForce = 1e-3;

struct WallPair {
  std::size_t low, high;
};

std::vector<WallPair> opposite_walls(const std::vector<PackWall>& walls) {
  std::vector<WallPair> out;
  for (std::size_t a = 0; a < walls.size(); ++a)
    for (std::size_t b = a + 1; b < walls.size(); ++b)
      if (softgrain::dot(walls[a].normal, walls[b].normal) < -1.0 + 1e-9) out.push_back({a, b});
  return out;
}

}  // namespace

Scales scales_of(const GrainPack& pack, const LeastWorkOptions& options) {
  double modulus = 0.0;
  double radius = 0.0;
  const auto n = static_cast<double>(pack.grains());
  for (const double e : pack.youngs_modulus) modulus += e;
  for (const double r : pack.radius) radius += r;
  const double energy = n > 0.0 ? modulus / n * (radius / n) * (radius / n) : 0.0;
  return {energy, options.force_floor * energy};
}

double residual_floor(const Scales& scales, const PackForces& forces) {
  const double mean = forces.contacts > 0 ? forces.contact_force / static_cast<double>(forces.contacts) : 0.0;
  return std::max(scales.floor_force, kRattlerForce * mean);
}

double worst_residual(const PackForces& forces, const GrainPack& pack, int stride, double floor_force) {
  const auto step = static_cast<std::size_t>(stride);
  double worst = 0.0;
  for (std::size_t g = 0; g < forces.largest2.size(); ++g) {
    double net2 = 0.0;
    for (std::size_t k = 0; k < step; k += 3) net2 = larger_or_nan(net2, norm2(triple(forces.force, g * step + k)));
    const double load = pack.weight.empty() ? 0.0 : pack.weight[g];
    const double scale = std::max({std::sqrt(forces.largest2[g]), load, floor_force});
    worst = larger_or_nan(worst, net2 == 0.0 ? 0.0 : std::sqrt(net2) / scale);
  }
  return worst;
}

Unknowns affine_guess(const PackProblem& problem, double part) {
  const GrainPack& pack = problem.pack();
  const auto stride = static_cast<std::size_t>(problem.stride());
  Unknowns out(problem.size(), 0.0);
  for (const WallPair& pair : opposite_walls(pack.walls)) {
    const Vec3 n = pack.walls[pair.low].normal;
    const Vec3 base = pack.walls[pair.low].point;
    const double width = softgrain::dot(pack.walls[pair.high].point - base, n);
    const Vec3 low = problem.wall_moves()[pair.low] * part;
    const Vec3 across = problem.wall_moves()[pair.high] * part - low;
    const Vec3 shear = across - n * softgrain::dot(across, n);
    for (std::size_t g = 0; g < pack.position.size(); ++g) {
      const double s = softgrain::dot(pack.position[g] - base, n) / width;
      const Vec3 move = n * (softgrain::dot(low, n) + s * softgrain::dot(across, n)) + shear * (s - 0.5);
      for (int k = 0; k < 3; ++k) out[g * stride + static_cast<std::size_t>(k)] += move[k];
    }
  }
  problem.symmetry().carry(out, problem.stride(), problem.wall_moves(), part);
  return out;
}

double longest_step(const Unknowns& step, const GrainPack& pack, int stride, double limit) {
  const auto width = static_cast<std::size_t>(stride);
  double fastest = 0.0;
  for (std::size_t g = 0; g < pack.radius.size(); ++g)
    for (std::size_t k = g * width; k < (g + 1) * width; k += 3) {
      const double move = std::sqrt(step[k] * step[k] + step[k + 1] * step[k + 1] + step[k + 2] * step[k + 2]);
      fastest = std::max(fastest, move / (limit * pack.radius[g]));
    }
  return 1.0 / fastest;
}

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
