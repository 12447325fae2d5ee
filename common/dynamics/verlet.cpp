#include "common/dynamics/verlet.h"

#include "common/dynamics/force_pass.h"

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
  for (auto u = std::size_t{0}; u < static_cast<std::size_t>(p.first_plane()); ++u)
    if (p.inverse_mass[u] > 0.0) p.force[u] += s.gravity * (1.0 / p.inverse_mass[u]);
}

template <int D>
void VelocityVerlet<D>::initialise(System<D>& system) {
  force_pass(system, 0.0);
  add_gravity(system);
}

template <int D>
void VelocityVerlet<D>::drift(System<D>& s) {
  auto& p = s.particles;
  old_force_ = p.force;
  old_torque_ = p.torque;
  const double half = 0.5 * dt_;
  for (std::size_t u = 0; u < p.force.size(); ++u) {
    const Vec<D> kick = p.force[u] * (half * p.inverse_mass[u]);
    const Vec<D> middle = p.velocity[u] + kick;
    p.sphere[u].x += middle * dt_;
    p.velocity[u] = middle + kick;
    p.spin[u] += p.torque[u] * (dt_ * p.inverse_inertia[u]);
  }
  if (s.cell.any_periodic()) s.cell.advance(dt_);
}

template <int D>
void VelocityVerlet<D>::correct(System<D>& s) const {
  auto& p = s.particles;
  const double half = 0.5 * dt_;
  for (std::size_t u = 0; u < p.force.size(); ++u) {
    p.velocity[u] += (p.force[u] - old_force_[u]) * (half * p.inverse_mass[u]);
    p.spin[u] += (p.torque[u] - old_torque_[u]) * (half * p.inverse_inertia[u]);
  }
}

template <int D>
void VelocityVerlet<D>::step(System<D>& system) {
  drift(system);
  force_pass(system, dt_);
  add_gravity(system);
  correct(system);
  system.contacts.commit();
  system.time += dt_;
  ++system.step;
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
