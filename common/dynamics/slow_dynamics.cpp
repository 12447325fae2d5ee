#include "common/dynamics/slow_dynamics.h"

#include <optional>

#include "common/dynamics/force_pass.h"
#include "common/dynamics/scaled_masses.h"
#include "common/dynamics/thread_choice.h"
#include "common/dynamics/verlet.h"
#include "common/io/interrupt.h"

namespace softgrain {

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
  PassThreads threads;
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

}  // namespace softgrain
