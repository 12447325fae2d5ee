// How far a system is from equilibrium, and why a relaxation ended.
#pragma once

#include <cstdint>
#include <string>

#include "common/system.h"

namespace softgrain {

struct Residual {
  double worst_force = 0.0;   ///< largest net force (or net moment over radius) on a body moved by forces [N]
  double mean_contact = 0.0;  ///< mean normal contact force [N]
  Slot worst_body = -1;
  double max_overlap = 0.0;   ///< largest overlap over the smaller radius involved
  std::int64_t contacts = 0;  ///< force-carrying

  /// worst_force over the larger of mean_contact and floor.
  [[nodiscard]] double relative(double floor) const {
    const double scale = mean_contact > floor ? mean_contact : floor;
    return scale > 0.0 ? worst_force / scale : 0.0;
  }
};

/// Residual from the forces of the last pass (gravity included when add_gravity was called) and the contacts as they
/// are.
template <int D>
Residual residual(const System<D>& system);

/// The largest net force alone: cheap, for a test within iterations.
template <int D>
double worst_net_force(const Particles<D>& particles);

/// The largest net force without a share of the bodies, rounded down, that are farthest from rest.
template <int D>
double worst_net_force(const Particles<D>& particles, double but_for);

/// What net forces are compared with.
struct ForceScale {
  double mean = 0.0;        ///< of the contact forces [N]
  double own_stress = 0.0;  ///< mean stress around the bodies; 0: the mean contact force is the scale of all [Pa]

  /// A sixth of the contact forces on a sphere of radius r under that stress, 4 pi r^2 own_stress in all, where that is
  /// above the mean: grains of one size have six neighbours. In the plane likewise, with 2 pi r own_stress.
  template <int D>
  [[nodiscard]] double of(double r) const;
};

/// The same where bodies have a scale of their own: net forces times scale.mean over the scale of their body.
template <int D>
double worst_net_force(const Particles<D>& particles, const ForceScale& scale, double but_for);

/// Why a relaxation ended.
enum class RelaxationEnd { not_run, converged, capped, diverged };

inline std::string to_string(RelaxationEnd end) {
  switch (end) {
    case RelaxationEnd::converged:
      return "converged";
    case RelaxationEnd::capped:
      return "capped";
    case RelaxationEnd::diverged:
      return "diverged";
    default:
      return "not run";
  }
}

struct RelaxationResult {
  RelaxationEnd end = RelaxationEnd::not_run;
  std::int64_t passes = 0;
  double residual = 0.0;  ///< largest net force over mean contact force (or floor)
};

/// Whether a relaxation ended farther from rest than another one: it did not converge where that did, or left a larger
/// residual.
inline bool farther_from_rest(const RelaxationResult& a, const RelaxationResult& b) {
  const bool rests = a.end == RelaxationEnd::converged;
  if (rests != (b.end == RelaxationEnd::converged)) return !rests;
  return !(a.residual <= b.residual);  // what is not a number is farthest
}

}  // namespace softgrain
