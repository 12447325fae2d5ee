// Velocity Verlet for bodies with contacts that depend on velocity.
#pragma once

#include <cstdint>
#include <vector>

#include "common/neighbours/skin.h"
#include "common/neighbours/verlet_list.h"
#include "common/system.h"

namespace softgrain {

/// Advances a system by steps of `dt`. Forces are evaluated at full-step positions with full-step (predicted)
/// velocities: half-step velocities in the tangential force give spurious friction at large size ratios (Vyas et al.
/// 2024). Bodies with zero inverse mass move with the velocity and spin they were given.
template <int D>
class VelocityVerlet {
 public:
  explicit VelocityVerlet(double dt) : dt_(dt) {}

  [[nodiscard]] double dt() const { return dt_; }

  /// Forces of the state as it is, without advancing any history. Needed once before the first step and after any
  /// change of positions from outside.
  void initialise(System<D>& system);

  void step(System<D>& system) { advance(system, 1); }

  /// Makes `steps` single steps, bit for bit, with one pass over the bodies less per step.
  void advance(System<D>& system, std::int64_t steps);

 private:
  void move(System<D>& system, bool correct_first);
  void sum_forces(System<D>& system);
  double drift(System<D>& system, std::size_t u, const SkinUse<D>& use);
  void correct(System<D>& system, std::size_t u) const;

  double dt_;
  ListWatch<D> watch_;
  std::vector<Stored<D>> kick_;     ///< change that the old forces gave to the predicted velocities
  std::vector<StoredRot<D>> turn_;  ///< change that the old torques gave to the predicted spins
};

/// Adds gravity to the forces of the last pass, for bodies moved by forces. A plane moved by forces feels no gravity:
/// it goes along its normal alone, under its load and the normal part of what the grains do to it.
template <int D>
void add_gravity(System<D>& system);

/// Sets all translational and angular velocities of bodies moved by forces to zero.
template <int D>
void stop_motion(Particles<D>& particles);

/// Translational plus rotational kinetic energy of bodies moved by forces [J].
template <int D>
double kinetic_energy(const Particles<D>& particles);

}  // namespace softgrain
