// Stretches of molecular dynamics in which some bodies are driven: how a pack rearranges with its own inertia.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/core/error.h"
#include "common/dynamics/time_step.h"
#include "common/neighbours/verlet_list.h"
#include "common/system.h"

namespace softgrain {

/// Share of sqrt(m/K), K the sum of all contact stiffnesses of a grain, that a step never exceeds: a heavily damped
/// contact evaluated once per step otherwise keeps jittering, and the forces come out plausible and 10-15 % low.
inline constexpr double kMultiContactedFraction = 0.5;

/// Time step of the published protocol over sqrt(m_min/k), k at 5 % overlap of the smallest grain.
inline constexpr double kPublishedStep = 0.2;

/// Masses of the bodies while they move.
enum class StretchMasses {
  raised,  ///< masses of the quickest bodies are raised until the step suits them (ScaledMasses)
  real     ///< the step has to suit them
};

/// Adds `share` times the motion that bodies, walls or the cell are given while a stretch lasts.
using Drive = std::function<void(System3& system, double share)>;

/// A velocity per body [m/s], and a spin [rad/s] (none at all: no body is turned).
Drive driven_at(std::vector<Vec3> velocity, std::vector<Vec3> spin = {});

/// Steps of velocity Verlet. What the drive gives (empty: nothing) is added at the begin and taken off at the end;
/// motion goes on from what it was and is left as it is: stopping it every now and then raises the force of a pack near
/// its threshold by a third. Throws Interrupted and UnusableResult (a grain is lost).
void run_steps(System3& system, const Drive& drive, double dt, std::int64_t steps, StretchMasses masses);

/// Takes these laws, and makes the list of neighbours anew, with their constants.
void take_laws(System3& system, const LawSet& laws);

/// Longest step that suits all bodies with their real masses, at most `fraction` of the natural time of the stiffest
/// pairing [s].
double real_mass_step(System3& system, double fraction, double crowded_fraction);

/// The step of a stretch is chosen for the contacts at its beginning. A grain that gets wedged between stiffer ones on
/// the way can be thrown through its shell by a step that has become too long, which many large grains with much
/// friction between them bring about. Calls `stretch(halves)`, which is to run the whole stretch with its time step
/// divided by `halves`; when that ends with UnusableResult, again from the same state with half the step, up to a
/// sixteenth. A stretch that goes through the first time is not touched. What was tried counts as cost.
template <class Experiment, class Work>
void with_steps_short_enough(Experiment& e, const Work& stretch) {
  constexpr int kShortest = 16;
  const Experiment before = e;
  for (int halves = 1;; halves *= 2) {
    try {
      stretch(halves);
      return;
    } catch (const UnusableResult&) {
      if (halves == kShortest) throw;
      const Cost spent = e.system.cost;
      e = before;
      e.system.cost = spent;
    }
  }
}

// Limits of what a scene may ask of dynamics: a time beyond them has more steps than can be counted, and a speed beyond
// them is not slow against sound in the grains. Speeds over sqrt(E/rho), times over R sqrt(rho/E).
inline constexpr double kSlowestApproach = 1e-7;
inline constexpr double kFastestApproach = 0.1;
inline constexpr double kLongestSettling = 1e6;
inline constexpr double kShortestStep = 0.01;  ///< over that of the published protocol

/// Dynamics with dashpots for a time [s], in steps of `step_factor` times that of the published protocol, masses raised
/// to match. Experiment: has `system` and set_damping(bool), and is without damping before and after.
template <class Experiment>
void run_slow(Experiment& e, const Drive& drive, double duration, double step_factor) {
  const double nominal = step_factor * kPublishedStep * step_limit(e.system).natural_time;
  const auto steps = static_cast<std::int64_t>(std::max(1.0, std::ceil(duration / nominal)));
  with_steps_short_enough(e, [&](int halves) {
    const double dt = duration / static_cast<double>(steps * halves);
    e.set_damping(true);
    run_steps(e.system, drive, dt, steps * halves, StretchMasses::raised);
    e.set_damping(false);
    update_neighbours(e.system);  // a checkpoint wants a list that is whole
  });
}

// Larger masses for the quickest bodies, so that a longer time step is stable; everything else keeps its inertia.

/// While this object lives every body has at least the mass m = K (dt/fraction)^2, K the sum of the stiffnesses of its
/// contacts (selective mass scaling); moments of inertia go along. The destructor restores the true masses. Constants
/// of the contacts that depend on masses are computed anew both times. Valid for motions that are slow against the
/// raised bodies; grains that touch nothing count with a share of the mean stiffness, so that their first touch is
/// stable.
template <int D>
class ScaledMasses {
 public:
  ScaledMasses(System<D>& system, double dt, double fraction);
  ~ScaledMasses();
  ScaledMasses(const ScaledMasses&) = delete;
  ScaledMasses& operator=(const ScaledMasses&) = delete;

 private:
  System<D>& system_;
  std::vector<double> inverse_mass_;
  std::vector<double> inverse_inertia_;
};

}  // namespace softgrain
