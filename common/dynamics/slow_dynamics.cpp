#include "common/dynamics/slow_dynamics.h"

#include <algorithm>
#include <optional>

#include "common/dynamics/fire.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/thread_choice.h"
#include "common/dynamics/verlet.h"
#include "common/io/interrupt.h"

namespace softgrain {

namespace {

constexpr double kLonelyShare = 0.3;  // of the mean stiffness per radius: what bodies without contacts count with

}  // namespace

Drive driven_at(std::vector<Vec3> velocity, std::vector<Vec3> spin) {
  return [velocity = std::move(velocity), spin = std::move(spin)](System3& system, double share) {
    for (std::size_t u = 0; u < velocity.size(); ++u) system.particles.velocity[u] += velocity[u] * share;
    for (std::size_t u = 0; u < spin.size(); ++u) system.particles.spin[u] += spin[u] * share;
  };
}

void run_steps(System3& system, const Drive& drive, double dt, std::int64_t steps, StretchMasses masses) {
  std::optional<ScaledMasses<3>> raised;
  if (masses == StretchMasses::raised) raised.emplace(system, dt, kMultiContactedFraction);
  if (drive) drive(system, 1.0);
  VelocityVerlet<3> integrator(dt);
  integrator.initialise(system);
  PassThreads threads(system.particles.sphere.size());
  for (std::int64_t k = 0; k < steps; ++k) {
    stop_if_interrupted("relaxing");
    integrator.step(system);
    threads.passed(1, system.contacts.size());
  }
  if (drive) drive(system, -1.0);
}

void take_laws(System3& system, const LawSet& laws) {
  system.laws = laws;
  system.neighbours.reference.clear();
}

double real_mass_step(System3& system, double fraction, double crowded_fraction) {
  BodyStiffness sums;
  force_pass(system, 0.0, sums);
  const auto& p = system.particles;
  double shortest2 = -1.0;
  for (std::size_t u = 0; u < sums.translation.size(); ++u) {
    if (!(p.inverse_mass[u] > 0.0) || !(sums.translation[u] > 0.0)) continue;
    const double t2 = 1.0 / (p.inverse_mass[u] * sums.translation[u]);
    if (shortest2 < 0.0 || t2 < shortest2) shortest2 = t2;
  }
  const double nominal = fraction * step_limit(system).natural_time;
  return shortest2 < 0.0 ? nominal : std::min(nominal, crowded_fraction * std::sqrt(shortest2));
}

template <int D>
ScaledMasses<D>::ScaledMasses(System<D>& system, double dt, double fraction)
    : system_(system),
      inverse_mass_(system.particles.inverse_mass),
      inverse_inertia_(system.particles.inverse_inertia) {
  BodyStiffness stiffness;
  force_pass(system, 0.0, stiffness, History::none);
  auto& p = system.particles;
  const double lonely = StiffnessSums(p, stiffness).per_radius(kLonelyShare);
  for (std::size_t u = 0; u < inverse_mass_.size(); ++u) {
    if (!(inverse_mass_[u] > 0.0)) continue;
    const double k = std::max(stiffness.translation[u], lonely * p.sphere[u].r);
    const double factor = std::max(1.0, k * (dt / fraction) * (dt / fraction) * inverse_mass_[u]);
    p.inverse_mass[u] /= factor;
    p.inverse_inertia[u] /= factor;
  }
  system.neighbours.reference.clear();  // the next pass rebuilds the list, with the constants of these masses
}

template <int D>
ScaledMasses<D>::~ScaledMasses() {
  system_.particles.inverse_mass = inverse_mass_;
  system_.particles.inverse_inertia = inverse_inertia_;
  system_.neighbours.reference.clear();
}

template class ScaledMasses<2>;
template class ScaledMasses<3>;

}  // namespace softgrain
