// A rectangular periodic cell whose lengths are degrees of freedom, driven by the difference of imposed and measured
// stress [CP 3.1].
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "common/system.h"

namespace softgrain {

/// What drives the cell, in the units of the system. Stresses are compressive positive, force per length in 2D.
template <int D>
struct StressControl {
  Vec<D> imposed{};           ///< Sigma per axis
  Vec<D> reference_length{};  ///< L0 of the strain eps, d(eps)/dt = -dL/dt/L0
  double cell_mass = 0.0;     ///< Mc of Mc d2(eps)/dt2 = Sigma_imposed - Sigma_measured; infinite: lengths are fixed
  double strain_rate_cap = std::numeric_limits<double>::infinity();  ///< of |d(eps)/dt|
};

/// Moves bodies and cell together: r = L s per axis, m L d2s/dt2 = F, so that the peculiar velocity v = L ds/dt obeys
/// dv/dt = F/m + (dL/dt/L) v; the stored velocity of a body is v + (dL/dt/L) r, which is what contacts see, also across
/// the boundary. Sigma_measured = (sum m v^2 + sum_pairs F r)/A per axis. Scheme: velocity Verlet with predicted
/// velocities, second order in dt. One thread; the same bits every time.
template <int D>
class StressCellVerlet {
 public:
  StressCellVerlet(double dt, const StressControl<D>& control) : dt_(dt), control_(control) {}

  /// Forces and stress of the state as it is, without advancing any history. Needed before the first step and after any
  /// change from outside.
  void initialise(System<D>& system);

  void step(System<D>& system);

  /// Of the last pass.
  [[nodiscard]] const Vec<D>& stress() const { return stress_; }

 private:
  void sum_forces(System<D>& system, double dt, History history);
  void drive(System<D>& system, double time);
  [[nodiscard]] Vec<D> peculiar(const System<D>& system, std::size_t u) const;

  double dt_;
  StressControl<D> control_;
  Vec<D> virial_{};
  Vec<D> stress_{};
  Vec<D> rate_{};               ///< dL/dt
  std::vector<Vec<D>> middle_;  ///< peculiar velocity in the middle of a step
  std::vector<Rot<D>> middle_spin_;
};

/// How far a powder is from the published equilibrium [CP 3.2], each over its limit: equilibrium when all are below 1.
template <int D>
struct PowderResidual {
  double force = 0.0;     ///< largest net force over 1e-4 F1
  double moment = 0.0;    ///< largest net moment over 1e-4 F1 a
  double pressure = 0.0;  ///< largest |imposed - measured| over 1e-4 F1/a (a: largest diameter)
  double kinetic = 0.0;   ///< kinetic energy per body over 5e-8 F1 a, without bodies in free flight (rattlers)

  [[nodiscard]] bool equilibrium() const { return force < 1.0 && moment < 1.0 && pressure < 1.0 && kinetic < 1.0; }
};

/// F1 = max(F0, P a). From the forces of the last pass; velocities relative to the moving cell. `lengths_free`: whether
/// the pressure counts.
template <int D>
PowderResidual<D> powder_residual(const System<D>& system, const Vec<D>& imposed, const Vec<D>& measured, double f1,
                                  double largest_diameter, bool lengths_free);

}  // namespace softgrain
