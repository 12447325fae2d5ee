#include "common/dynamics/scaled_masses.h"

#include <algorithm>

#include "common/dynamics/fire.h"
#include "common/dynamics/force_pass.h"

namespace softgrain {

namespace {

constexpr double kLonelyShare = 0.3;  // of the mean stiffness per radius: what bodies without contacts count with

}  // namespace

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
