// Dynamic relaxation with per-body mass scaling and adaptive viscous damping: a fast way to rest that follows the same
// contact laws, friction included, without physical inertia.
#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "common/dynamics/fire.h"
#include "common/dynamics/force_pass.h"
#include "common/dynamics/residual.h"
#include "common/neighbours/verlet_list.h"
#include "common/system.h"

namespace softgrain {

struct DampedOptions {
  double tolerance = 1e-2;           ///< largest net force over mean contact force at the end
  double unbalanced_fraction = 0.0;  ///< share of the bodies, rounded down, whose net force may be larger
  double force_floor = 0.0;          ///< the mean contact force never counts for less than this [N]
  double own_stress = 0.0;           ///< ForceScale::own_stress [Pa]
  std::int64_t max_passes = 20000;
  double max_move = 0.05;  ///< largest move of a body per pass, in its radius
  /// No body moves farther per pass than this times the root mean square move of all, both in radii (MoveLimit).
  double max_lead = std::numeric_limits<double>::infinity();
  double least_stiffness = 0.0;  ///< no body counts as softer than this times its radius [Pa]; 0: a share of the mean
};

/// What comes to rest together with the bodies and is none: walls or a cell held by stress. Its coordinates are strains
/// that carry all bodies along; masses, forces and velocities are its own.
template <int D>
class RelaxingFrame {
 public:
  virtual ~RelaxingFrame() = default;
  /// Sums over the coordinates, see Fire::steer.
  struct Sums {
    double power = 0.0;
    double speed2 = 0.0;
    double pull2 = 0.0;

    Sums& operator+=(const Sums& o) {
      power += o.power;
      speed2 += o.speed2;
      pull2 += o.pull2;
      return *this;
    }
  };

  virtual void scale_masses(const System<D>& system, const BodyStiffness& stiffness, const PseudoMasses& masses) = 0;
  /// Takes the forces on the frame from those on the bodies.
  virtual Sums feel(System<D>& system) = 0;
  /// v becomes keep v + pull F/m.
  virtual void steer(double keep, double pull) = 0;
  /// v += F/m step; moves everything by v step and adds that motion to the velocities of all bodies, which release()
  /// takes off again: contacts between see the whole of it.
  virtual void carry(System<D>& system, double step) = 0;
  virtual void release(System<D>& system) = 0;
  /// How far the stress is from the one asked for, over what it may be: at rest up to 1.
  [[nodiscard]] virtual double residual(System<D>& system) = 0;
  /// Whether it has gone so far that going on is in vain: the relaxation ends there, as with its last pass.
  [[nodiscard]] virtual bool out_of_reach() const { return false; }
  /// Told at every test for convergence: how far the bodies are.
  virtual void see(const RelaxationResult& /*so_far*/) {}
};

/// What a relaxation under way needs to go on in the same bits, beside the system and the frame.
struct RelaxationState {
  RelaxationResult so_far;
  Fire fire;
  BodyStiffness stiffness;  ///< of the last pass
};

/// How a relaxation is kept from being lost.
struct RelaxationKeeping {
  const RelaxationState* from = nullptr;                   ///< goes on from there; null: begins
  std::function<void(const RelaxationState&)> state_is{};  ///< told at every test for convergence that does not end it
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
  RelaxationResult relax(System<D>& system) { return relax(system, nullptr, {}); }
  /// Relaxes the system together with a frame, until both are at rest.
  RelaxationResult relax(System<D>& system, RelaxingFrame<D>& frame, const RelaxationKeeping& keeping = {}) {
    return relax(system, &frame, keeping);
  }

 private:
  RelaxationResult relax(System<D>& system, RelaxingFrame<D>* frame, const RelaxationKeeping& keeping);
  void begin(System<D>& system);
  void scale_masses(System<D>& system, RelaxingFrame<D>* frame);
  /// What Fire asks for, and the sum of squares of speeds in radii.
  struct BodySums : RelaxingFrame<D>::Sums {
    double relative2 = 0.0;

    BodySums& operator+=(const BodySums& o) {
      RelaxingFrame<D>::Sums::operator+=(o);
      relative2 += o.relative2;
      return *this;
    }
  };
  /// Those of bodies begin to end - 1.
  [[nodiscard]] BodySums sums_of(const Particles<D>& p, std::size_t begin, std::size_t end) const;
  Fire::Steering steer(System<D>& system, RelaxingFrame<D>* frame);
  /// The largest move in the next pass, the first being 0 [radii].
  [[nodiscard]] double longest_move(std::int64_t pass) const;
  /// Velocities take the steering and the forces, which go to zero; places take the velocities. Returns the square of
  /// the largest share of its margin in the neighbour list that a body uses up per time.
  double move(System<D>& system, const Fire::Steering& steering, double longest, std::size_t begin, std::size_t end);
  void turn(Particles<D>& p, const Fire::Steering& steering, std::size_t begin, std::size_t end) const;
  [[nodiscard]] bool checks_convergence(std::int64_t passes) const;
  void move_all(System<D>& system, const Fire::Steering& steering, std::int64_t pass);

  DampedOptions options_;
  std::vector<double> inverse_mass_;  ///< pseudo, per body
  std::vector<double> inverse_inertia_;
  bool turns_ = true;           ///< some body can
  double typical_speed_ = 0.0;  ///< root mean square speed in radii, where moves are limited by it [1/s]
  RelaxationState state_;
  ListWatch<D> watch_;
};

}  // namespace softgrain
