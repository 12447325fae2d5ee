#include "common/dynamics/damped_relaxation.h"

#include <algorithm>
#include <cmath>

#include "common/core/in_pieces.h"
#include "common/dynamics/residual.h"
#include "common/dynamics/verlet.h"
#include "common/io/interrupt.h"

namespace softgrain {

namespace {

/// Passes between two updates of masses and two tests for convergence.
constexpr std::int64_t kMassInterval = PseudoMasses::kInterval;

template <class V>
void limit_length(V& v, double longest) {
  const double size2 = norm2(v);
  if (size2 > longest * longest) v *= longest / std::sqrt(size2);
}

}  // namespace

template <int D>
void DampedRelaxation<D>::scale_masses(System<D>& s, RelaxingFrame<D>* frame) {
  const auto& p = s.particles;
  inverse_mass_.assign(static_cast<std::size_t>(p.size()), 0.0);
  inverse_inertia_.assign(static_cast<std::size_t>(p.size()), 0.0);
  const StiffnessSums sums(p, stiffness_);
  const PseudoMasses masses(sums.stiffness, sums.radii, options_.least_stiffness,
                            sums.stiffness > 0.0 ? 0.0 : worst_net_force(p));
  in_pieces(inverse_mass_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u) {
      const double r = p.sphere[u].r;
      if (p.inverse_mass[u] > 0.0) inverse_mass_[u] = masses.inverse_mass(stiffness_.translation[u], r);
      if (p.inverse_inertia[u] > 0.0) inverse_inertia_[u] = masses.inverse_inertia(stiffness_.rotation[u], r);
    }
  });
  if (frame != nullptr) frame->scale_masses(s, stiffness_, masses);
}

template <int D>
typename RelaxingFrame<D>::Sums DampedRelaxation<D>::sums_of(const Particles<D>& p, std::size_t begin,
                                                             std::size_t end) const {
  typename RelaxingFrame<D>::Sums sums;
  for (std::size_t u = begin; u < end; ++u) {
    if (inverse_mass_[u] > 0.0) {
      sums.power += dot(p.velocity[u], p.force[u]);
      sums.speed2 += norm2(p.velocity[u]) / inverse_mass_[u];
      sums.pull2 += norm2(p.force[u]) * inverse_mass_[u];
    }
    if (turns_ && inverse_inertia_[u] > 0.0) {
      sums.power += dot(p.spin[u], p.torque[u]);
      sums.speed2 += norm2(p.spin[u]) / inverse_inertia_[u];
      sums.pull2 += norm2(p.torque[u]) * inverse_inertia_[u];
    }
  }
  return sums;
}

template <int D>
Fire::Steering DampedRelaxation<D>::steer(System<D>& s, RelaxingFrame<D>* frame) {
  auto sums = sum_in_pieces<typename RelaxingFrame<D>::Sums>(
      inverse_mass_.size(), [&](std::size_t begin, std::size_t end) { return sums_of(s.particles, begin, end); });
  if (frame != nullptr) sums += frame->feel(s);
  const Fire::Steering steering = fire_.steer(sums.power, sums.speed2, sums.pull2);
  if (frame != nullptr) frame->steer(steering.keep, steering.pull);
  return steering;
}

template <int D>
void DampedRelaxation<D>::move(Particles<D>& p, const Fire::Steering& steering, std::size_t begin, std::size_t end) {
  const double fastest = options_.max_move / fire_.step;
  for (std::size_t u = begin; u < end; ++u) {
    Vec<D> velocity = p.velocity[u];
    if (!steering.stop) velocity = velocity * steering.keep + p.force[u] * (steering.pull * inverse_mass_[u]);
    if (inverse_mass_[u] > 0.0) {
      if (steering.stop) velocity = {};
      velocity += p.force[u] * (fire_.step * inverse_mass_[u]);
      limit_length(velocity, fastest * p.sphere[u].r);
      p.sphere[u].x += velocity * fire_.step;
    }
    p.velocity[u] = velocity;
  }
  if (!turns_) return;
  for (std::size_t u = begin; u < end; ++u) {
    Rot<D> spin = p.spin[u];
    if (!steering.stop) spin = spin * steering.keep + p.torque[u] * (steering.pull * inverse_inertia_[u]);
    if (inverse_inertia_[u] > 0.0) {
      if (steering.stop) spin = {};
      spin += p.torque[u] * (fire_.step * inverse_inertia_[u]);
      limit_length(spin, fastest);
    }
    p.spin[u] = spin;
  }
}

template <int D>
RelaxationResult DampedRelaxation<D>::relax(System<D>& s, RelaxingFrame<D>* frame) {
  RelaxationResult result;
  stop_motion(s.particles);
  const auto& turn = s.particles.inverse_inertia;
  turns_ = std::any_of(turn.begin(), turn.end(), [](double inverse) { return inverse > 0.0; });
  fire_ = {};
  force_pass(s, 0.0, stiffness_, History::none);
  add_gravity(s);
  for (;;) {
    if (result.passes % kMassInterval == 0) {
      const double scale = std::max(stiffness_.mean_force(), options_.force_floor);
      const double worst = worst_net_force(s.particles, options_.restless);
      result.residual = scale > 0.0 ? worst / scale : 0.0;
      if (!std::isfinite(worst))
        result.end = RelaxationEnd::diverged;
      else if (worst <= options_.tolerance * scale && (frame == nullptr || frame->residual(s) <= 1.0))
        result.end = RelaxationEnd::converged;
      else if (result.passes >= options_.max_passes || (frame != nullptr && frame->out_of_reach()))
        result.end = RelaxationEnd::capped;
      if (frame != nullptr) frame->see(result);
      if (result.end != RelaxationEnd::not_run) break;
      stop_if_interrupted("relaxing");
      scale_masses(s, frame);
    }
    const Fire::Steering steering = steer(s, frame);
    in_pieces(inverse_mass_.size(),
              [&](std::size_t begin, std::size_t end) { move(s.particles, steering, begin, end); });
    if (frame != nullptr) frame->carry(s, fire_.step);
    if ((result.passes + 1) % kMassInterval == 0)
      force_pass(s, fire_.step, stiffness_, History::advance);
    else
      force_pass(s, fire_.step, History::advance);
    if (frame != nullptr) frame->release(s);
    add_gravity(s);
    ++result.passes;
  }
  stop_motion(s.particles);
  return result;
}

template class DampedRelaxation<2>;
template class DampedRelaxation<3>;

}  // namespace softgrain
