#include "common/dynamics/stress_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/dynamics/force_pass.h"
#include "common/dynamics/parallel_pass.h"
#include "common/dynamics/thread_choice.h"
#include "common/neighbours/skin.h"

namespace softgrain {

/// Forces must be zero before. Virials are summed in list order on one thread: the same bits whoever made them.
template <int D>
void StressCellVerlet<D>::sum_forces(System<D>& s, double dt, History history) {
  add_contact_forces(s, dt, virials_, history);
  virial_ = {};
  for (const Vec<D>& of_pair : virials_) virial_ += of_pair;
}

/// Stress of the state, and the cell's own acceleration for a time.
template <int D>
void StressCellVerlet<D>::drive(const Cell<D>& cell, double time) {
  const double area = cell.volume();
  for (int k = 0; k < D; ++k) {
    stress_[k] = (virial_[k] + kinetic_[k]) / area;
    if (std::isinf(control_.cell_mass)) continue;
    const double push = control_.reference_length[k] * (control_.imposed[k] - stress_[k]) / control_.cell_mass;
    const double drag = push * rate_[k] > 0.0 ? cell_drag_ : 0.0;
    rate_[k] -= time * (push + drag * rate_[k]);
    rate_[k] = std::clamp(rate_[k], -control_.edge_speed_cap, control_.edge_speed_cap);
  }
}

template <int D>
void StressCellVerlet<D>::initialise(System<D>& s) {
  auto& p = s.particles;
  const std::size_t bodies = p.sphere.size();
  mass_.resize(bodies);
  peculiar_.resize(bodies);
  spin_.resize(bodies);
  middle_.resize(bodies);
  middle_spin_.resize(bodies);
  for (int k = 0; k < D; ++k) rate_[k] = s.cell.velocity_gradient[k][k] * s.cell.edges[k][k];
  watch_.forget();
  watch_.require_list(s);
  kinetic_ = {};
  for (std::size_t u = 0; u < bodies; ++u) {
    p.force[u] = {};
    p.torque[u] = {};
    mass_[u] = 1.0 / p.inverse_mass[u];
    spin_[u] = p.spin[u];
    for (int k = 0; k < D; ++k) {
      peculiar_[u][k] = p.velocity[u][k] - s.cell.velocity_gradient[k][k] * p.sphere[u].x[k];
      kinetic_[k] += mass_[u] * peculiar_[u][k] * peculiar_[u][k];
    }
  }
  sum_forces(s, 0.0, History::none);
  drive(s.cell, 0.0);
}

/// Positions and predicted velocities one step on; forces are set to zero for the pass.
template <int D>
template <bool kDrag>
void StressCellVerlet<D>::move_bodies(System<D>& s, const Vec<D>& growth, const Vec<D>& stretch, const Vec<D>& way) {
  auto& p = s.particles;
  const double half = 0.5 * dt_;
  const double fastest2 = max_over_bodies(s, [&](std::size_t u) {
    const double loss = kDrag ? half * drag_[u] : 0.0;
    const Rot<D> turn = static_cast<Rot<D>>(p.torque[u]) * (half * p.inverse_inertia[u]);
    middle_spin_[u] = spin_[u] * (1.0 - loss) + turn;
    p.spin[u] = middle_spin_[u] + turn;
    for (int k = 0; k < D; ++k) {
      const double kick = half * (p.force[u][k] * p.inverse_mass[u]);
      middle_[u][k] = peculiar_[u][k] + kick + (growth[k] - loss) * peculiar_[u][k];
      p.sphere[u].x[k] = stretch[k] * p.sphere[u].x[k] + way[k] * middle_[u][k];
      p.velocity[u][k] = middle_[u][k] + kick + s.cell.velocity_gradient[k][k] * p.sphere[u].x[k];
    }
    p.force[u] = {};
    p.torque[u] = {};
    const double used2 = norm2(middle_[u]) * s.neighbours.inverse_skin2[u];
    return std::isnan(used2) ? std::numeric_limits<double>::infinity() : used2;  // no maximum would tell of it
  });
  watch_.moved(dt_ * (std::sqrt(fastest2) + SkinUse<D>(s).strain_rate()));
}

/// The cell and all that is in it one step on.
template <int D>
void StressCellVerlet<D>::move(System<D>& s) {
  drive(s.cell, 0.5 * dt_);
  Vec<D> growth;
  Vec<D> stretch;
  Vec<D> way;
  for (int k = 0; k < D; ++k) {
    const double before = s.cell.edges[k][k];
    const double after = before + dt_ * rate_[k];
    growth[k] = 0.5 * dt_ * rate_[k] / before;
    stretch[k] = after / before;
    way[k] = dt_ * after / (0.5 * (before + after));
    s.cell.edges[k][k] = after;
    s.cell.velocity_gradient[k][k] = rate_[k] / after;
  }
  if (drag_.empty())
    move_bodies<false>(s, growth, stretch, way);
  else
    move_bodies<true>(s, growth, stretch, way);
}

/// Velocities at the end of the step, from the forces there: the mirror image in time of the first half, so that free
/// flight is exact, v/L = v'/L'. A rebuild may have carried a body to another image; its
/// stored velocity went along, the peculiar one stayed.
template <int D>
template <bool kDrag>
void StressCellVerlet<D>::correct_bodies(System<D>& s) {
  const auto& p = s.particles;
  const double half = 0.5 * dt_;
  Vec<D> growth;
  for (int k = 0; k < D; ++k) growth[k] = s.cell.velocity_gradient[k][k];
  (void)max_over_bodies(s, [&](std::size_t u) {
    const double drag = kDrag ? drag_[u] : 0.0;
    const double left = kDrag ? 1.0 / (1.0 + half * drag) : 1.0;
    spin_[u] = (middle_spin_[u] + static_cast<Rot<D>>(p.torque[u]) * (half * p.inverse_inertia[u])) * left;
    for (int k = 0; k < D; ++k) {
      const double kicked = middle_[u][k] + half * (p.force[u][k] * p.inverse_mass[u]);
      peculiar_[u][k] = kicked / (1.0 + half * (drag - growth[k]));
    }
    return 0.0;
  });
  kinetic_ = {};
  for (std::size_t u = 0; u < peculiar_.size(); ++u)
    for (int k = 0; k < D; ++k) kinetic_[k] += mass_[u] * peculiar_[u][k] * peculiar_[u][k];
}

template <int D>
void StressCellVerlet<D>::correct(System<D>& s) {
  if (drag_.empty())
    correct_bodies<false>(s);
  else
    correct_bodies<true>(s);
  drive(s.cell, 0.5 * dt_);
  for (int k = 0; k < D; ++k) s.cell.velocity_gradient[k][k] = rate_[k] / s.cell.edges[k][k];
}

/// The velocities of bodies, as the cell moves now.
template <int D>
void StressCellVerlet<D>::publish(System<D>& s) const {
  auto& p = s.particles;
  for (std::size_t u = 0; u < peculiar_.size(); ++u) {
    p.spin[u] = spin_[u];
    for (int k = 0; k < D; ++k) p.velocity[u][k] = peculiar_[u][k] + s.cell.velocity_gradient[k][k] * p.sphere[u].x[k];
  }
}

template <int D>
void StressCellVerlet<D>::advance(System<D>& s, std::int64_t steps) {
  PassThreads threads(s.particles.sphere.size());
  for (std::int64_t k = 0; k < steps; ++k) {
    move(s);
    watch_.require_list(s);
    sum_forces(s, dt_, History::advance);
    correct(s);
    threads.passed(1, s.contacts.size());
    s.time += dt_;
    ++s.step;
  }
  publish(s);
}

template class StressCellVerlet<2>;
}  // namespace softgrain
