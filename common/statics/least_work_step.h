// One quasi-static increment of a system by least work: the same idea as advance() of a grain pack, for the contact
// laws, shells and histories of the force loop.
#pragma once

#include <vector>

#include "common/dynamics/force_pass.h"
#include "common/dynamics/residual.h"
#include "common/system.h"

namespace softgrain {

struct LeastWorkStepOptions {
  double tolerance = 1e-1;       ///< largest net force over mean contact force at the end
  double force_floor = 0.0;      ///< the mean contact force never counts for less than this [N]
  std::int64_t max_passes = 80;  ///< a loose pack has no nearby equilibrium: dynamics finds one sooner
  double max_move = 0.05;        ///< largest move of a body per pass, in its radius
};

/// Finds the equilibrium that follows when bodies with no mass of their own (planes, shells, driven grains) are moved.
/// Unknowns are the displacements and rotations of all other bodies since the reference state, the one that was
/// committed last; tangential springs are those of the reference state plus all sliding since, cut at the Coulomb limit
/// of the current normal force (return mapping, [QS 2.1] with the better rule of 2.4). So the state does not depend on
/// the way that the iteration took, only on the size of the increment. The minimiser is a nonlinear conjugate gradient
/// (Polak-Ribiere, restarted) preconditioned by the contact stiffness of each body, with a secant line search on
/// residual . direction. Contact laws must be without damping.
class LeastWorkStep {
 public:
  explicit LeastWorkStep(const LeastWorkStepOptions& options) : options_(options) {}

  /// `moves`: displacement of every body [m], exact for those without mass, a first guess for the others; empty: none.
  /// Converged: the new state is committed, velocities are zero, `moves` holds the displacements found. Otherwise the
  /// system is put back to the reference state, motion included (forces are those of the last try), and `moves` is left
  /// as it was.
  RelaxationResult advance(System3& system, std::vector<Vec3>& moves);

 private:
  using Moves = std::vector<Vec3>;

  RelaxationResult minimise(System3& system);
  void start(const System3& system, const Moves& moves);
  void place(System3& system) const;
  void evaluate(System3& system, bool stiffness);
  void precondition(const System3& system);
  bool choose_direction(const System3& system, bool restart);
  [[nodiscard]] double slope(const System3& system) const;
  [[nodiscard]] double longest_step(const System3& system) const;
  void move_by(const System3& system, double step);
  void search(System3& system, bool stiffness);
  void put_back(System3& system) const;
  static void stop(System3& system);

  LeastWorkStepOptions options_;
  std::int64_t passes_ = 0;
  BodyStiffness stiffness_;
  std::vector<double> inverse_translation_;  ///< preconditioner per body, 0 for bodies without mass
  std::vector<double> inverse_rotation_;
  Moves origin_;                                   ///< positions of the reference state
  std::vector<Stored<3>> velocity_, rate_;         ///< its velocities and spins
  Moves shift_, turn_;                             ///< displacements and rotations since the reference state
  Moves direction_, spin_;                         ///< search direction
  std::vector<Stored<3>> old_force_, old_torque_;  ///< forces and torques at the last iterate
  Moves base_shift_, base_turn_;                   ///< displacements and rotations where the line search starts
  double old_product_ = 0.0;                       ///< preconditioned residual product at the last iterate
  double slope_ = 0.0;                             ///< residual . direction where the line search starts
  double step_ = 1.0;                              ///< step that served last
};

}  // namespace softgrain
