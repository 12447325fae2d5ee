// A rectangular periodic cell whose lengths are degrees of freedom, driven by the difference of imposed and measured
// stress [CP 3.1].
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "common/neighbours/verlet_list.h"
#include "common/system.h"

namespace softgrain {

/// What drives the cell, in the units of the system. Stresses are compressive positive, force per length in 2D.
template <int D>
struct StressControl {
  Vec<D> imposed{};           ///< Sigma per axis
  Vec<D> reference_length{};  ///< L0 of the strain eps, d(eps)/dt = -dL/dt/L0
  double cell_mass = 0.0;     ///< Mc of Mc d2(eps)/dt2 = Sigma_imposed - Sigma_measured; infinite: lengths are fixed
  double edge_speed_cap = std::numeric_limits<double>::infinity();  ///< upper limit of |dL/dt| [length/time]
  double drag =
      0.0;  ///< gamma of -gamma m v, likewise on spins and on the rate of the cell: settles what has come together
};

/// Moves bodies and cell together: r = L s per axis, m L d2s/dt2 = F, so that the peculiar velocity v = L ds/dt obeys
/// dv/dt = F/m + (dL/dt/L) v; the stored velocity of a body is v + (dL/dt/L) r, which is what contacts see, also across
/// the boundary. Sigma_measured = (sum m v^2 + sum_pairs F r)/A per axis. Scheme: velocity Verlet with predicted
/// velocities, second order in dt (first in the drag of the cell), free flight exact. The same bits on any number of
/// threads.
template <int D>
class StressCellVerlet {
 public:
  StressCellVerlet(double dt, const StressControl<D>& control) : dt_(dt), control_(control) {}

  /// Forces and stress of the state as it is, without advancing any history. Needed before the first step and after any
  /// change from outside.
  void initialise(System<D>& system);

  void step(System<D>& system) { advance(system, 1); }

  /// Makes `steps` single steps, bit for bit, with one pass over the bodies less per step.
  void advance(System<D>& system, std::int64_t steps);

  /// Sets the drag from the next step on: gamma of -gamma m v (peculiar) and -gamma I spin per body, and gamma of the
  /// rate of the cell [1/time]. The drag of the cell acts while its rate goes against what pushes it. It ends
  /// vibrations and does not hold back a pack that gives way. Empty: no drag of bodies.
  void set_drag(double of_cell, std::vector<double> of_bodies) {
    cell_drag_ = of_cell;
    drag_ = std::move(of_bodies);
  }

  /// Stress of the last pass.
  [[nodiscard]] const Vec<D>& stress() const { return stress_; }

 private:
  void move(System<D>& system);
  void sum_forces(System<D>& system, double dt, History history);
  void correct(System<D>& system);
  template <bool kDrag>
  void move_bodies(System<D>& system, const Vec<D>& growth, const Vec<D>& stretch, const Vec<D>& way);
  template <bool kDrag>
  void correct_bodies(System<D>& system);
  void drive(const Cell<D>& cell, double time);
  void publish(System<D>& system) const;

  double dt_;
  StressControl<D> control_;
  double cell_drag_ = 0.0;
  std::vector<double> drag_;
  std::vector<Vec<D>> virials_;  ///< of every pair
  Vec<D> virial_{};              ///< their sum
  Vec<D> kinetic_{};             ///< sum m v^2 per axis
  Vec<D> stress_{};
  Vec<D> rate_{};  ///< dL/dt
  std::vector<double> mass_;
  std::vector<Vec<D>> peculiar_;  ///< peculiar velocity at the end of a step
  std::vector<Rot<D>> spin_;      ///< spin at the end of a step
  std::vector<Vec<D>> middle_;    ///< peculiar velocity in the middle of a step
  std::vector<Rot<D>> middle_spin_;
  ListWatch<D> watch_;
};

}  // namespace softgrain
