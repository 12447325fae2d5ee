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

}  // namespace softgrain
