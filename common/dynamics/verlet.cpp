#include "common/dynamics/verlet.h"

#include <algorithm>
#include <cmath>

#include "common/core/parallel_tasks.h"
#include "common/core/quad.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/parallel_pass.h"
#include "common/dynamics/thread_choice.h"

namespace softgrain {

namespace {

template <int D>
void load_planes(Particles<D>& p) {
  for (Slot plane = p.first_plane(); plane < p.size(); ++plane) {
    const auto u = static_cast<std::size_t>(plane);
    if (!(p.inverse_mass[u] > 0.0)) continue;
    const Vec<D>& n = p.normal_of(plane);
    p.force[u] = n * (dot(p.force[u], n) + p.plane_load[static_cast<std::size_t>(plane - p.first_plane())]);
  }
}

}  // namespace

template <int D>
void add_gravity(System<D>& s) {
  auto& p = s.particles;
  load_planes(p);
  if (s.gravity == Vec<D>{}) return;
  const auto planes = static_cast<std::size_t>(p.first_plane());
  (void)max_over_bodies(s, [&](std::size_t u) {
    if (u < planes && p.inverse_mass[u] > 0.0) p.force[u] += s.gravity * (1.0 / p.inverse_mass[u]);
    return 0.0;
  });
}

template <int D>
void VelocityVerlet<D>::initialise(System<D>& system) {
  force_pass(system, 0.0, History::none);
  add_gravity(system);
  watch_.forget();
}

/// Position and predicted velocity one step on; forces are set to zero for the pass. Returns the largest share of its
/// margin in the neighbour list that a body can have used up in this step.
template <int D>
double VelocityVerlet<D>::drift(System<D>& s, std::size_t u, const SkinUse<D>& use) {
  auto& p = s.particles;
  const double half = 0.5 * dt_;
  const Quad kick = quad_of(p.force[u]) * (half * p.inverse_mass[u]);
  const Quad middle = quad_of(p.velocity[u]) + kick;
  const Quad turn = quad_of(p.torque[u]) * (half * p.inverse_inertia[u]);
  const Quad middle_spin = quad_of(p.spin[u]) + turn;
  p.sphere[u].x += vec_of<D>(middle) * dt_;
  store(p.velocity[u], middle + kick);
  store(p.spin[u], middle_spin + turn);
  store(kick_[u], kick);
  store(turn_[u], turn);
  store(p.force[u], Quad{});
  store(p.torque[u], Quad{});
  return use.rate2(s, u, vec_of<D>(middle));
}

template <int D>
void VelocityVerlet<D>::correct(System<D>& s, std::size_t u) const {
  auto& p = s.particles;
  const double half = 0.5 * dt_;
  store(p.velocity[u], quad_of(p.velocity[u]) + (quad_of(p.force[u]) * (half * p.inverse_mass[u]) - quad_of(kick_[u])));
  store(p.spin[u], quad_of(p.spin[u]) + (quad_of(p.torque[u]) * (half * p.inverse_inertia[u]) - quad_of(turn_[u])));
}

template <int D>
void VelocityVerlet<D>::move(System<D>& s, bool correct_first) {
  const std::size_t bodies = s.particles.force.size();
  kick_.resize(bodies);
  turn_.resize(bodies);
  const SkinUse<D> use(s);
  const double fastest2 = max_over_bodies(s, [&](std::size_t u) {
    if (correct_first) correct(s, u);
    return drift(s, u, use);
  });
  if (s.cell.any_periodic()) s.cell.advance(dt_);
  watch_.moved(dt_ * (std::sqrt(fastest2) + use.strain_rate()));
}

template <int D>
void VelocityVerlet<D>::sum_forces(System<D>& s) {
  watch_.require_list(s);
  add_contact_forces(s, dt_, History::advance);
  add_gravity(s);
}

template <int D>
void VelocityVerlet<D>::advance(System<D>& s, std::int64_t steps) {
  PassThreads threads(s.particles.sphere.size());
  for (std::int64_t k = 0; k < steps; ++k) {
    move(s, k > 0);
    sum_forces(s);
    threads.passed(1, s.contacts.size());
    s.time += dt_;
    ++s.step;
  }
  if (steps <= 0) return;
  (void)max_over_bodies(s, [&](std::size_t u) {
    correct(s, u);
    return 0.0;
  });
}

template <int D>
void stop_motion(Particles<D>& p) {
  for (std::size_t u = 0; u < p.velocity.size(); ++u) {
    if (p.inverse_mass[u] > 0.0) p.velocity[u] = {};
    if (p.inverse_inertia[u] > 0.0) p.spin[u] = {};
  }
}

template <int D>
double kinetic_energy(const Particles<D>& p) {
  double sum = 0.0;
  for (std::size_t u = 0; u < p.velocity.size(); ++u) {
    if (p.inverse_mass[u] > 0.0) sum += 0.5 * norm2(p.velocity[u]) / p.inverse_mass[u];
    if (p.inverse_inertia[u] > 0.0) sum += 0.5 * norm2(p.spin[u]) / p.inverse_inertia[u];
  }
  return sum;
}

template class VelocityVerlet<2>;
template class VelocityVerlet<3>;
template void add_gravity<2>(System<2>&);
template void add_gravity<3>(System<3>&);
template void stop_motion<2>(Particles<2>&);
template void stop_motion<3>(Particles<3>&);
template double kinetic_energy<2>(const Particles<2>&);
template double kinetic_energy<3>(const Particles<3>&);

}  // namespace softgrain
