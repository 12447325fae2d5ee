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
