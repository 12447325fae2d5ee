// Dynamic relaxation with per-body mass scaling and adaptive viscous damping: a fast way to rest that follows the same
// contact laws, friction included, without physical inertia.
#pragma once

#include <vector>

#include "common/dynamics/fire.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/relaxation_result.h"
#include "common/system.h"

namespace softgrain {

struct DampedOptions {
  double tolerance = 1e-2;   ///< largest net force over mean contact force at the end
  double force_floor = 0.0;  ///< the mean contact force never counts for less than this [N]
  std::int64_t max_passes = 20000;
  double max_move = 0.05;        ///< largest move of a body per pass, in its radius
  double least_stiffness = 0.0;  ///< no body counts as softer than this times its radius [Pa]; 0: a share of the mean
};

/// Every body gets the pseudo-mass of its own stiffness (sum over its contacts), so that all grains relax at one rate
/// whatever their size. Damping adapts to the motion (FIRE, Bitzek et al. 2006): velocities are steered towards the
/// forces, the step grows while the motion goes downhill, and everything stops when it goes uphill. It acts on the
/// motion of bodies against the frame, never on contacts: contact damping proportional to sqrt(k m) is unstable under
/// mass scaling. Contact laws must be without damping (their dashpots would see pseudo-velocities).
template <int D>
class DampedRelaxation {
 public:
  explicit DampedRelaxation(const DampedOptions& options) : options_(options) {}

  /// Relaxes until the tolerance is met. Leaves all velocities zero and the forces of the final state in place.
  RelaxationResult relax(System<D>& system);

 private:
  void scale_masses(System<D>& system);
  void steer(System<D>& system);
  void move(System<D>& system);

  DampedOptions options_;
  BodyStiffness stiffness_;
  std::vector<double> inverse_mass_;  ///< pseudo, per body
  std::vector<double> inverse_inertia_;
  Fire fire_;
};

}  // namespace softgrain
