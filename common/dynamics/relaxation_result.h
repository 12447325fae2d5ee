// Why a relaxation ended and how good its state is.
#pragma once

#include <cstdint>
#include <string>

namespace softgrain {

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
