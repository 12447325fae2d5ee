// Time step from stiffness and mass.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "common/system.h"

namespace softgrain {

/// What a law answers to a contact as it is or, if that is stiffer along the normal, as it begins to unload. Laws
/// without a branch for unloading have the first alone.
template <class Law, int D>
ContactResponse<D> steepest_response(const Law& law, const ContactState<D>& state) {
  ContactResponse<D> out = law.evaluate(state);
  if constexpr (Law::traits.has_unloading) {
    ContactState<D> turned = state;
    turned.memory = std::max(state.memory, std::nextafter(state.overlap, std::numeric_limits<double>::infinity()));
    const ContactResponse<D> back = law.evaluate(turned);
    if (back.normal_stiffness > out.normal_stiffness) out = back;
  }
  return out;
}

/// The contact that sets the step.
struct StepLimit {
  double natural_time = 0.0;  ///< smallest sqrt(m/k) over bodies and laws [s]
  Slot body = -1;             ///< the body that sets it
  std::int32_t law = -1;      ///< the law that sets it
  double stiffness = 0.0;     ///< k [N/m]
};

/// sqrt(m/k) of the lightest, stiffest pairing: for every grain and every law its material takes part in, k is the
/// tangent stiffness against an equal partner at an overlap of `overlap_ratio` of its radius (soft contacts: at Delta =
/// 0.35, loading or beginning to unload; cohesive disks: the stiffest of their springs and of the slope of the
/// attraction). A stable step is a fraction of it: 0.2 is as good as 0.05 in soft-particle measurements, 0.4 is biased
/// by 7-16 %.
template <int D>
StepLimit step_limit(const System<D>& system, double overlap_ratio = 0.05);

/// Whether the tangential spring of a law ever bears anything; without friction it slides at once.
template <class Law>
bool has_grip(const Law& law) {
  if constexpr (requires { law.friction; })
    return law.friction > 0.0;
  else
    return Law::traits.has_tangential;
}

/// The tangential spring that bears the shortest step.
struct SlideLimit {
  double step = std::numeric_limits<double>::infinity();  ///< largest stable step [s]
  Slot body = -1;                                         ///< the body that sets it
  std::int32_t law = -1;                                  ///< the law that sets it
};

/// Two equal bodies that slide against each other and turn with it: h^2 Kt (1/m + r^2/I) < 1, as Kt counts twice in
/// stable_step(). Pairings, overlaps and soft contacts as in step_limit(). Springs softer than that along the normal
/// are left to step_limit(), as are those of cohesive disks, which it takes for stiffnesses like others.
template <int D>
SlideLimit slide_limit(const System<D>& system, double overlap_ratio = 0.05);

/// Largest fraction of StepLimit::natural_time that is accepted for a step.
inline constexpr double kLargestStepFraction = 0.6;

// The largest time step at which a state is stable: all contacts that a body has count, together.

/// Whether dashpots count. Without them longer steps pass: what dashpots across the contact do then is chatter, which
/// the Coulomb limit holds.
enum class Dashpots { count, leave_out };

struct StableStep {
  double step = std::numeric_limits<double>::infinity();  ///< [s]; infinite without contacts
  Slot body = -1;                                         ///< the one that moves most in the mode that breaks first
  std::int64_t contacts = 0;                              ///< number of contacts of this body
};

/// About the state as it is, contacts neither opening nor sliding. The step h of VelocityVerlet is stable as long as
/// the largest eigenvalue of M^-1 (Kn h^2/4 + Kt h^2/2 + C h) is below 1: Kn and Kt the normal and tangential stiffness
/// of the network of contacts, translation and rotation, C its dashpots (a mode that changes its sign in every step
/// solves the equations of motion where it is 1). Kt counts twice because tangential springs add up predicted
/// velocities. One normal spring without dashpot: h < 2/omega. Multi-contact laws count with what each contact feels of
/// itself, contacts with an unloading branch as if they began to unload where that is stiffer. `enough`: when a bound
/// for every body by itself, from the sums over its contacts, says that this step is stable, that bound is what comes
/// back; otherwise the mode is found by iteration. Throws UnusableResult as update_neighbours does. The state is left
/// alone.
template <int D>
StableStep stable_step(const System<D>& system, double enough, Dashpots dashpots = Dashpots::count);

/// Share of StableStep::step that is accepted for a step: contacts deepen, and stiffness with them.
inline constexpr double kLargestStableShare = 0.8;

}  // namespace softgrain
