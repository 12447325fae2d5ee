#include "common/dynamics/damped_relaxation.h"

#include <algorithm>
#include <cmath>

#include "common/dynamics/residual.h"
#include "common/dynamics/verlet.h"

namespace softgrain {

namespace {

/// Passes between two updates of masses and two tests for convergence.
constexpr std::int64_t kMassInterval = 10;
/// Pseudo-mass over contact stiffness; 1/2 is the limit of stability (Gershgorin) for a fixed stiffness.
constexpr double kMassMargin = 1.0;

/// Rolls the pseudo-velocity forward and returns it. Central difference with viscous damping c and unit step.
template <class V>
V damped_velocity(const V& v, const V& force, double inverse_mass, double c) {
  return (v * (2.0 - c) + force * (2.0 * inverse_mass)) * (1.0 / (2.0 + c));
}

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
  const double floor_per_radius = radii > 0.0 ? 0.1 * sum / radii : 0.0;
  for (std::size_t u = 0; u < inverse_mass_.size(); ++u) {
    const double r = p.sphere[u].r;
    const double floor = std::max(floor_per_radius * r, 1e-300);
    if (p.inverse_mass[u] > 0.0) inverse_mass_[u] = 1.0 / (kMassMargin * std::max(stiffness_.translation[u], floor));
    if (p.inverse_inertia[u] > 0.0)
      inverse_inertia_[u] = 1.0 / (kMassMargin * std::max(stiffness_.rotation[u], 0.4 * floor * r * r));
  }
}

template <int D>
void DampedRelaxation<D>::adapt_damping(const System<D>& s) {
  const auto& p = s.particles;
  double curvature = 0.0;
  double weight = 0.0;
  for (std::size_t u = 0; u < inverse_mass_.size(); ++u) {
    if (inverse_mass_[u] > 0.0) {
      curvature += dot(p.velocity[u], old_force_[u] - p.force[u]);
      weight += norm2(p.velocity[u]) / inverse_mass_[u];
    }
    if (inverse_inertia_[u] > 0.0) {
      curvature += dot(p.spin[u], old_torque_[u] - p.torque[u]);
      weight += norm2(p.spin[u]) / inverse_inertia_[u];
    }
  }
  const double lambda = weight > 0.0 ? std::max(curvature / weight, 0.0) : 0.0;
  const double wanted = std::clamp(2.0 * std::sqrt(lambda), 0.01, 1.8);
  damping_ = 0.9 * damping_ + 0.1 * wanted;
}

template <int D>
void DampedRelaxation<D>::move(System<D>& s) {
  auto& p = s.particles;
  for (std::size_t u = 0; u < inverse_mass_.size(); ++u) {
    const double r = p.sphere[u].r;
    if (inverse_mass_[u] > 0.0) {
      p.velocity[u] = damped_velocity(p.velocity[u], p.force[u], inverse_mass_[u], damping_);
      limit_length(p.velocity[u], options_.max_move * r);
      p.sphere[u].x += p.velocity[u];
    }
    if (inverse_inertia_[u] > 0.0) {
      p.spin[u] = damped_velocity(p.spin[u], p.torque[u], inverse_inertia_[u], damping_);
      limit_length(p.spin[u], options_.max_move);
    }
  }
}

template <int D>
RelaxationResult DampedRelaxation<D>::relax(System<D>& s) {
  RelaxationResult result;
  stop_motion(s.particles);
  damping_ = 0.2;
  force_pass(s, 0.0, stiffness_);
  add_gravity(s);
  for (;;) {
    if (result.passes % kMassInterval == 0) {
      const double scale = std::max(stiffness_.mean_force(), options_.force_floor);
      const double worst = worst_net_force(s.particles);
      result.residual = scale > 0.0 ? worst / scale : 0.0;
      if (!std::isfinite(worst)) result.end = RelaxationEnd::diverged;
      if (worst <= options_.tolerance * scale) result.end = RelaxationEnd::converged;
      if (result.end == RelaxationEnd::not_run && result.passes >= options_.max_passes) result.end = RelaxationEnd::capped;
      if (result.end != RelaxationEnd::not_run) break;
      scale_masses(s);
    }
    move(s);
    old_force_ = s.particles.force;
    old_torque_ = s.particles.torque;
    if ((result.passes + 1) % kMassInterval == 0)
      force_pass(s, 1.0, stiffness_);
    else
      force_pass(s, 1.0);
    add_gravity(s);
    s.contacts.commit();
    adapt_damping(s);
    ++result.passes;
  }
  stop_motion(s.particles);
  return result;
}

template class DampedRelaxation<2>;
template class DampedRelaxation<3>;

}  // namespace softgrain
