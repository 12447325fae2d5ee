// Dynamic relaxation with per-body mass scaling and adaptive viscous damping: a fast way to rest that follows the same
// contact laws, friction included, without physical inertia.
#pragma once

#include <vector>

#include "common/dynamics/force_pass.h"
#include "common/dynamics/relaxation_result.h"
#include "common/system.h"

namespace softgrain {

struct DampedOptions {
  double tolerance = 1e-2;       ///< largest net force over mean contact force at the end
  double force_floor = 0.0;      ///< the mean contact force never counts for less than this [N]
  std::int64_t max_passes = 20000;
  double max_move = 0.05;        ///< largest move of a body per pass, in its radius
};

/// Pseudo-time has unit step; every body gets the mass that makes its own stiffness critical to it (sum of contact stiffness),
/// so that all grains relax at one rate whatever their size. Damping: c = 2 sqrt(lambda), lambda the Rayleigh quotient of the
/// stiffness along the present motion (Underwood 1983), i.e. critical for the slowest mode that moves. It acts on the motion of
/// bodies against the frame, never on contacts: contact damping proportional to sqrt(k m) is unstable under mass scaling.
/// Contact laws must be without damping (their dashpots would see pseudo-velocities).
template <int D>
class DampedRelaxation {
 public:
  explicit DampedRelaxation(const DampedOptions& options) : options_(options) {}

  /// Relaxes until the tolerance is met. Leaves all velocities zero and the forces of the final state in place.
  RelaxationResult relax(System<D>& system);

 private:
  void scale_masses(System<D>& system);
  void move(System<D>& system);
  void adapt_damping(const System<D>& system);

  DampedOptions options_;
  BodyStiffness stiffness_;
  std::vector<double> inverse_mass_;     ///< pseudo, per body
  std::vector<double> inverse_inertia_;
  std::vector<Vec<D>> old_force_;
  std::vector<Rot<D>> old_torque_;
  double damping_ = 0.0;                 ///< c, per unit pseudo-time
};

}  // namespace softgrain
