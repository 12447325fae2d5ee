#include "common/statics/least_work_step.h"

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/dynamics/fire.h"
#include "common/dynamics/residual.h"
#include "common/dynamics/verlet.h"
#include "common/io/interrupt.h"

namespace softgrain {

namespace {

constexpr std::int64_t kRestart = 50;
/// Iterations between two updates of the preconditioner.
constexpr std::int64_t kStiffnessInterval = 10;
/// The line search is content when residual . direction has fallen to this share.
constexpr double kContent = 0.5;
/// Stiffness per radius of bodies that touch little, over the mean: floppy grains move as little as needed.
constexpr double kDrag = 0.1;

bool is_free(const Particles<3>& p, std::size_t u) { return p.inverse_mass[u] > 0.0; }

}  // namespace

void LeastWorkStep::start(const System3& s, const Moves& moves) {
  const auto n = static_cast<std::size_t>(s.particles.size());
  passes_ = 0;
  step_ = 1.0;
  old_product_ = 0.0;
  for (Moves* v : {&shift_, &turn_, &direction_, &spin_}) v->assign(n, {});
  old_force_.assign(n, {});
  old_torque_.assign(n, {});
  if (!moves.empty()) shift_ = moves;
  velocity_ = s.particles.velocity;
  rate_ = s.particles.spin;
  origin_.resize(n);
  for (std::size_t u = 0; u < n; ++u) origin_[u] = s.particles.sphere[u].x;
}

/// The loop sees the whole displacement since the reference state as one step of unit time.
void LeastWorkStep::place(System3& s) const {
  auto& p = s.particles;
  for (std::size_t u = 0; u < origin_.size(); ++u) {
    p.sphere[u].x = origin_[u] + shift_[u];
    p.velocity[u] = shift_[u];
    p.spin[u] = turn_[u];
  }
}

void LeastWorkStep::evaluate(System3& s, bool stiffness) {
  place(s);
  if (stiffness)
    force_pass(s, 1.0, stiffness_);
  else
    force_pass(s, 1.0);
  add_gravity(s);
  ++passes_;
  if (stiffness) precondition(s);
}

void LeastWorkStep::precondition(const System3& s) {
  const auto& p = s.particles;
  inverse_translation_.assign(origin_.size(), 0.0);
  inverse_rotation_.assign(origin_.size(), 0.0);
  const StiffnessSums sums(p, stiffness_);
  const PseudoMasses masses(sums.stiffness, sums.radii, 0.0, 0.0);
  for (std::size_t u = 0; u < origin_.size(); ++u) {
    if (!is_free(p, u)) continue;
    const double r = p.sphere[u].r;
    inverse_translation_[u] = masses.inverse_mass(stiffness_.translation[u], r);
    if (p.inverse_inertia[u] > 0.0) inverse_rotation_[u] = masses.inverse_inertia(stiffness_.rotation[u], r);
  }
}

/// Polak-Ribiere, never negative; false when no force is left to follow.
bool LeastWorkStep::choose_direction(const System3& s, bool restart) {
  const auto& p = s.particles;
  double product = 0.0;
  double mixed = 0.0;
  for (std::size_t u = 0; u < origin_.size(); ++u) {
    const Vec3 pull = p.force[u] * inverse_translation_[u];
    const Vec3 twist = p.torque[u] * inverse_rotation_[u];
    product += dot(pull, p.force[u]) + dot(twist, p.torque[u]);
    mixed += dot(pull, old_force_[u]) + dot(twist, old_torque_[u]);
  }
  double keep = restart || !(old_product_ > 0.0) ? 0.0 : std::max(0.0, (product - mixed) / old_product_);
  for (int attempt = 0; attempt < 2; ++attempt) {
    for (std::size_t u = 0; u < origin_.size(); ++u) {
      direction_[u] = p.force[u] * inverse_translation_[u] + direction_[u] * keep;
      spin_[u] = p.torque[u] * inverse_rotation_[u] + spin_[u] * keep;
    }
    slope_ = slope(s);
    if (slope_ > 0.0) break;
    keep = 0.0;  // not downhill: follow the forces
  }
  old_product_ = product;
  old_force_ = p.force;
  old_torque_ = p.torque;
  return slope_ > 0.0;
}

double LeastWorkStep::slope(const System3& s) const {
  const auto& p = s.particles;
  double sum = 0.0;
  for (std::size_t u = 0; u < origin_.size(); ++u)
    if (is_free(p, u)) sum += dot(p.force[u], direction_[u]) + dot(p.torque[u], spin_[u]);
  return sum;
}

double LeastWorkStep::longest_step(const System3& s) const {
  double largest = 0.0;
  for (std::size_t u = 0; u < origin_.size(); ++u) {
    if (!is_free(s.particles, u)) continue;
    const double r = s.particles.sphere[u].r;
    largest = std::max({largest, norm2(direction_[u]) / (r * r), norm2(spin_[u])});
  }
  return largest > 0.0 ? options_.max_move / std::sqrt(largest) : 0.0;
}

void LeastWorkStep::move_by(const System3& s, double step) {
  for (std::size_t u = 0; u < origin_.size(); ++u) {
    if (!is_free(s.particles, u)) continue;
    shift_[u] = base_shift_[u] + direction_[u] * step;
    turn_[u] = base_turn_[u] + spin_[u] * step;
  }
}

/// One pass when the step that served last serves again, two otherwise.
void LeastWorkStep::search(System3& s, bool stiffness) {
  base_shift_ = shift_;
  base_turn_ = turn_;
  const double limit = longest_step(s);
  const double first = std::min(step_, limit);
  move_by(s, first);
  evaluate(s, stiffness);
  const double after = slope(s);
  const double secant = after < slope_ ? first * slope_ / (slope_ - after) : 4.0 * first;
  if (std::abs(after) <= kContent * slope_) {
    step_ = std::clamp(secant, 0.3 * first, 3.0 * first);
    return;
  }
  const double second = std::min(std::clamp(secant, 0.1 * first, 4.0 * first), limit);
  if (std::abs(second - first) > 1e-3 * first) {
    move_by(s, second);
    evaluate(s, stiffness);
  }
  step_ = second;
}

void LeastWorkStep::put_back(System3& s) const {
  auto& p = s.particles;
  for (std::size_t u = 0; u < origin_.size(); ++u) p.sphere[u].x = origin_[u];
  p.velocity = velocity_;
  p.spin = rate_;
}

void LeastWorkStep::stop(System3& s) {
  std::fill(s.particles.velocity.begin(), s.particles.velocity.end(), Stored<3>{});
  std::fill(s.particles.spin.begin(), s.particles.spin.end(), Stored<3>{});
}

RelaxationResult LeastWorkStep::minimise(System3& s) {
  RelaxationResult result;
  evaluate(s, true);
  for (std::int64_t iteration = 0; result.end == RelaxationEnd::not_run; ++iteration) {
    stop_if_interrupted("relaxing");
    const double scale = std::max(stiffness_.mean_force(), options_.force_floor);
    const double worst = worst_net_force(s.particles);
    result.residual = scale > 0.0 ? worst / scale : 0.0;
    if (!std::isfinite(worst))
      result.end = RelaxationEnd::diverged;
    else if (worst <= options_.tolerance * scale)
      result.end = RelaxationEnd::converged;
    else if (passes_ >= options_.max_passes || !choose_direction(s, iteration % kRestart == 0))
      result.end = RelaxationEnd::capped;
    else
      search(s, iteration % kStiffnessInterval == kStiffnessInterval - 1);
  }
  return result;
}

RelaxationResult LeastWorkStep::advance(System3& s, Moves& moves) {
  start(s, moves);
  RelaxationResult result;
  try {
    result = minimise(s);
  } catch (const UnusableResult&) {  // a try that throws a grain out of its shell is a try that failed, no more
    result.end = RelaxationEnd::diverged;
  }
  result.passes = passes_;
  if (result.end == RelaxationEnd::converged) {
    s.contacts.commit();
    stop(s);
    moves = shift_;
  } else {
    put_back(s);
  }
  return result;
}

}  // namespace softgrain
