#include "common/dynamics/damped_relaxation.h"

#include <algorithm>
#include <cmath>

#include "common/core/parallel_tasks.h"
#include "common/core/quad.h"
#include "common/dynamics/parallel_pass.h"
#include "common/dynamics/residual.h"
#include "common/dynamics/thread_choice.h"
#include "common/dynamics/verlet.h"
#include "common/io/interrupt.h"
#include "common/neighbours/skin.h"

namespace softgrain {

namespace {

/// Passes between two updates of masses and two tests for convergence.
constexpr std::int64_t kMassInterval = PseudoMasses::kInterval;

template <int N>
void limit_length(Quad& v, double longest) {
  const double size2 = norm2(vec_of<N>(v));
  if (size2 > longest * longest) v *= longest / std::sqrt(size2);
}

}  // namespace

template <int D>
void DampedRelaxation<D>::scale_masses(System<D>& s, RelaxingFrame<D>* frame) {
  const auto& p = s.particles;
  inverse_mass_.assign(static_cast<std::size_t>(p.size()), 0.0);
  inverse_inertia_.assign(static_cast<std::size_t>(p.size()), 0.0);
  const StiffnessSums sums(p, state_.stiffness);
  const PseudoMasses masses(sums.stiffness, sums.radii, options_.least_stiffness,
                            sums.stiffness > 0.0 ? 0.0 : worst_net_force(p));
  in_pieces(inverse_mass_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u) {
      const double r = p.sphere[u].r;
      if (p.inverse_mass[u] > 0.0) inverse_mass_[u] = masses.inverse_mass(state_.stiffness.translation[u], r);
      if (p.inverse_inertia[u] > 0.0) inverse_inertia_[u] = masses.inverse_inertia(state_.stiffness.rotation[u], r);
    }
  });
  if (frame != nullptr) frame->scale_masses(s, state_.stiffness, masses);
}

template <int D>
typename DampedRelaxation<D>::BodySums DampedRelaxation<D>::sums_of(const Particles<D>& p, std::size_t begin,
                                                                    std::size_t end) const {
  BodySums sums;
  const bool limits = std::isfinite(options_.max_lead);
  for (std::size_t u = begin; u < end; ++u) {
    if (inverse_mass_[u] > 0.0) {
      if (limits) sums.relative2 += norm2(p.velocity[u]) / (p.sphere[u].r * p.sphere[u].r);
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
  BodySums sums = sum_in_pieces<BodySums>(
      inverse_mass_.size(), [&](std::size_t begin, std::size_t end) { return sums_of(s.particles, begin, end); },
      piece_threads(s));
  typical_speed_ = std::sqrt(sums.relative2 / static_cast<double>(inverse_mass_.size()));
  if (frame != nullptr) static_cast<typename RelaxingFrame<D>::Sums&>(sums) += frame->feel(s);
  const Fire::Steering steering = state_.fire.steer(sums.power, sums.speed2, sums.pull2);
  if (frame != nullptr) frame->steer(steering.keep, steering.pull);
  return steering;
}

template <int D>
double DampedRelaxation<D>::longest_move(std::int64_t pass) const {
  if (!std::isfinite(options_.max_lead)) return options_.max_move;
  return MoveLimit{options_.max_move, options_.max_lead}.at(state_.fire.step * typical_speed_, pass);
}

template <int D>
double DampedRelaxation<D>::move(System<D>& s, const Fire::Steering& steering, double longest, std::size_t begin,
                                 std::size_t end) {
  auto& p = s.particles;
  const SkinUse<D> use(s);
  const double fastest = longest / state_.fire.step;
  double used2 = 0.0;
  for (std::size_t u = begin; u < end; ++u) {
    Quad velocity = quad_of(p.velocity[u]);
    const Quad force = quad_of(p.force[u]);
    store(p.force[u], Quad{});
    if (!steering.stop) velocity = velocity * steering.keep + force * (steering.pull * inverse_mass_[u]);
    if (inverse_mass_[u] > 0.0) {
      if (steering.stop) velocity = Quad{};
      velocity += force * (state_.fire.step * inverse_mass_[u]);
      limit_length<D>(velocity, fastest * p.sphere[u].r);
      p.sphere[u].x += vec_of<D>(velocity) * state_.fire.step;
      used2 = std::max(used2, use.rate2(s, u, vec_of<D>(velocity)));
    }
    store(p.velocity[u], velocity);
  }
  turn(p, steering, begin, end);
  return used2;
}

/// Forces of rotation go to zero too.
template <int D>
void DampedRelaxation<D>::turn(Particles<D>& p, const Fire::Steering& steering, std::size_t begin,
                               std::size_t end) const {
  for (std::size_t u = begin; u < end; ++u) {
    const Quad torque = quad_of(p.torque[u]);
    store(p.torque[u], Quad{});
    if (!turns_) continue;
    Quad spin = quad_of(p.spin[u]);
    if (!steering.stop) spin = spin * steering.keep + torque * (steering.pull * inverse_inertia_[u]);
    if (inverse_inertia_[u] > 0.0) {
      if (steering.stop) spin = Quad{};
      spin += torque * (state_.fire.step * inverse_inertia_[u]);
      limit_length<kRot<D>>(spin, options_.max_move / state_.fire.step);
    }
    store(p.spin[u], spin);
  }
}

template <int D>
void DampedRelaxation<D>::move_all(System<D>& s, const Fire::Steering& steering, std::int64_t pass) {
  const double longest = longest_move(pass);
  const double used2 = joined_in_pieces<double>(
      inverse_mass_.size(), [&](std::size_t begin, std::size_t end) { return move(s, steering, longest, begin, end); },
      [](double& most, double piece) { most = std::max(most, piece); }, piece_threads(s));
  watch_.moved(state_.fire.step * std::sqrt(used2));
}

/// Whether convergence is checked after this many passes.
template <int D>
bool DampedRelaxation<D>::checks_convergence(std::int64_t passes) const {
  return passes % kMassInterval == 0 || passes >= options_.max_passes;
}

template <int D>
void DampedRelaxation<D>::begin(System<D>& s) {
  state_ = {};
  stop_motion(s.particles);
  force_pass(s, 0.0, state_.stiffness, History::none);
  add_gravity(s);
}

template <int D>
RelaxationResult DampedRelaxation<D>::relax(System<D>& s, RelaxingFrame<D>* frame, const RelaxationKeeping& keeping) {
  RelaxationResult& result = state_.so_far;
  PassThreads threads(s.particles.sphere.size());
  const auto& turn = s.particles.inverse_inertia;
  turns_ = std::any_of(turn.begin(), turn.end(), [](double inverse) { return inverse > 0.0; });
  const bool flows = !(s.cell.velocity_gradient == Matrix<D>{});  // which time in here does not drive
  if (keeping.from == nullptr)
    begin(s);
  else
    state_ = *keeping.from;
  watch_.forget();
  for (;;) {
    if (checks_convergence(result.passes)) {
      const double scale = std::max(state_.stiffness.mean_force(), options_.force_floor);
      const double worst = worst_net_force(s.particles, {scale, options_.own_stress}, options_.unbalanced_fraction);
      result.residual = scale > 0.0 ? worst / scale : 0.0;
      if (!std::isfinite(worst))
        result.end = RelaxationEnd::diverged;
      else if (worst <= options_.tolerance * scale && (frame == nullptr || frame->residual(s) <= 1.0))
        result.end = RelaxationEnd::converged;
      else if (result.passes >= options_.max_passes || (frame != nullptr && frame->out_of_reach()))
        result.end = RelaxationEnd::capped;
      if (frame != nullptr) frame->see(result);
      if (result.end != RelaxationEnd::not_run) break;
      if (keeping.state_is) keeping.state_is(state_);
      stop_if_interrupted("relaxing");
      if (result.passes > 0) threads.passed(kMassInterval, s.contacts.size());
      scale_masses(s, frame);
    }
    const Fire::Steering steering = steer(s, frame);
    move_all(s, steering, result.passes);
    if (frame != nullptr) frame->carry(s, state_.fire.step);
    if (frame != nullptr || flows) watch_.forget();
    watch_.require_list(s);
    if (checks_convergence(result.passes + 1))
      add_contact_forces(s, state_.fire.step, state_.stiffness, History::advance);
    else
      add_contact_forces(s, state_.fire.step, History::advance);
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
