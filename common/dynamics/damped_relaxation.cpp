#include "common/dynamics/damped_relaxation.h"

#include <algorithm>
#include <cmath>

#include "common/dynamics/residual.h"
#include "common/dynamics/verlet.h"
#include "common/io/interrupt.h"

namespace softgrain {

namespace {

/// Passes between two updates of masses and two tests for convergence.
constexpr std::int64_t kMassInterval = 10;

// FIRE, in units where a body alone on its springs has frequency 1 (mass = stiffness).
constexpr double kLargestStep = 1.0;  // 2/sqrt(2) is the limit of stability (Gershgorin) for a fixed stiffness
constexpr double kFirstStep = 0.3;
constexpr double kGrow = 1.1;
constexpr double kShrink = 0.5;
constexpr double kFirstMixing = 0.15;
constexpr double kMixingDecay = 0.99;
constexpr std::int64_t kPatience = 5;

template <class V>
void limit_length(V& v, double longest) {
  const double size2 = norm2(v);
  if (size2 > longest * longest) v *= longest / std::sqrt(size2);
}

}  // namespace

template <int D>
void DampedRelaxation<D>::scale_masses(System<D>& s) {
  const auto& p = s.particles;
  inverse_mass_.assign(static_cast<std::size_t>(p.size()), 0.0);
  inverse_inertia_.assign(static_cast<std::size_t>(p.size()), 0.0);
  double sum = 0.0;
  double radii = 0.0;
  for (std::size_t u = 0; u < inverse_mass_.size(); ++u) {
    if (!(p.inverse_mass[u] > 0.0)) continue;
    sum += stiffness_.translation[u];
    radii += p.sphere[u].r;
  }
  // A body without contacts gets a share of the mean stiffness per size, so that a new contact does not throw it.
  // Where hardly anything touches, that mean says nothing, and grains that meet would find themselves too light for
  // their contact.
  const double floor_per_radius = std::max(radii > 0.0 ? 0.1 * sum / radii : 0.0, options_.least_stiffness);
  // With no contact anywhere, weights alone pull: a body then moves its radius in a step of 1, before the limit on
  // moves.
  const double pull = sum > 0.0 ? 0.0 : worst_net_force(p);
  for (std::size_t u = 0; u < inverse_mass_.size(); ++u) {
    const double r = p.sphere[u].r;
    const double floor = std::max({floor_per_radius * r, r > 0.0 ? pull / r : 0.0, 1e-300});
    if (p.inverse_mass[u] > 0.0) inverse_mass_[u] = 1.0 / std::max(stiffness_.translation[u], floor);
    if (p.inverse_inertia[u] > 0.0) inverse_inertia_[u] = 1.0 / std::max(stiffness_.rotation[u], 0.4 * floor * r * r);
  }
}

template <int D>
void DampedRelaxation<D>::steer(System<D>& s) {
  auto& p = s.particles;
  double power = 0.0;
  double speed2 = 0.0;
  double pull2 = 0.0;
  for (std::size_t u = 0; u < inverse_mass_.size(); ++u) {
    if (inverse_mass_[u] > 0.0) {
      power += dot(p.velocity[u], p.force[u]);
      speed2 += norm2(p.velocity[u]) / inverse_mass_[u];
      pull2 += norm2(p.force[u]) * inverse_mass_[u];
    }
    if (inverse_inertia_[u] > 0.0) {
      power += dot(p.spin[u], p.torque[u]);
      speed2 += norm2(p.spin[u]) / inverse_inertia_[u];
      pull2 += norm2(p.torque[u]) * inverse_inertia_[u];
    }
  }
  if (power < 0.0) {
    stop_motion(p);
    step_ *= kShrink;
    mixing_ = kFirstMixing;
    downhill_ = 0;
  } else {
    const double turn = pull2 > 0.0 ? mixing_ * std::sqrt(speed2 / pull2) : 0.0;
    for (std::size_t u = 0; u < inverse_mass_.size(); ++u) {
      p.velocity[u] = p.velocity[u] * (1.0 - mixing_) + p.force[u] * (turn * inverse_mass_[u]);
      p.spin[u] = p.spin[u] * (1.0 - mixing_) + p.torque[u] * (turn * inverse_inertia_[u]);
    }
    if (++downhill_ > kPatience) {
      step_ = std::min(step_ * kGrow, kLargestStep);
      mixing_ *= kMixingDecay;
    }
  }
}

template <int D>
void DampedRelaxation<D>::move(System<D>& s) {
  auto& p = s.particles;
  for (std::size_t u = 0; u < inverse_mass_.size(); ++u) {
    if (inverse_mass_[u] > 0.0) {
      p.velocity[u] += p.force[u] * (step_ * inverse_mass_[u]);
      limit_length(p.velocity[u], options_.max_move * p.sphere[u].r / step_);
      p.sphere[u].x += p.velocity[u] * step_;
    }
    if (inverse_inertia_[u] > 0.0) {
      p.spin[u] += p.torque[u] * (step_ * inverse_inertia_[u]);
      limit_length(p.spin[u], options_.max_move / step_);
    }
  }
}

template <int D>
RelaxationResult DampedRelaxation<D>::relax(System<D>& s) {
  RelaxationResult result;
  stop_motion(s.particles);
  step_ = kFirstStep;
  mixing_ = kFirstMixing;
  downhill_ = 0;
  force_pass(s, 0.0, stiffness_, History::none);
  add_gravity(s);
  for (;;) {
    if (result.passes % kMassInterval == 0) {
      const double scale = std::max(stiffness_.mean_force(), options_.force_floor);
      const double worst = worst_net_force(s.particles);
      result.residual = scale > 0.0 ? worst / scale : 0.0;
      if (!std::isfinite(worst))
        result.end = RelaxationEnd::diverged;
      else if (worst <= options_.tolerance * scale)
        result.end = RelaxationEnd::converged;
      else if (result.passes >= options_.max_passes)
        result.end = RelaxationEnd::capped;
      if (result.end != RelaxationEnd::not_run) break;
      stop_if_interrupted("relaxing");
      scale_masses(s);
    }
    steer(s);
    move(s);
    if ((result.passes + 1) % kMassInterval == 0)
      force_pass(s, step_, stiffness_, History::advance);
    else
      force_pass(s, step_, History::advance);
    add_gravity(s);
    ++result.passes;
  }
  stop_motion(s.particles);
  return result;
}

template class DampedRelaxation<2>;
template class DampedRelaxation<3>;

}  // namespace softgrain
