#include "macrosim/pressing.h"

#include <algorithm>
#include <cmath>

namespace softgrain {

namespace {

/// Share of the bodies that may still be on their way: to wait for the last loose one takes ever longer, the more there
/// are (of 40,000 bodies 8,660 passes under the last pressure instead of 2,020, the fraction the same to 1e-4). The
/// test begins by bringing all to rest with its own law.
constexpr double kUnbalancedFraction = 1.0 / 2000.0;
/// Largest move per pass of the few bodies that are still on their way, in typical moves. In a million bodies some
/// always begin to fly, and the neighbour list was made every other pass for them. With 6 most bodies wait for others,
/// with 15 most lists remain.
constexpr double kLead = 10.0;

}  // namespace

DampedOptions pressing_options(const MacroSpec& spec, bool last, double load, double bodies, double mean_radius) {
  DampedOptions options;
  options.tolerance = last ? spec.protocol.tolerance : std::max(kLoosePressing, spec.protocol.tolerance);
  options.max_passes = spec.protocol.max_passes;
  options.unbalanced_fraction = kUnbalancedFraction;
  if (kUnbalancedFraction * bodies >= 1.0) options.max_lead = kLead;
  options.force_floor = 1e-2 * load / bodies;
  // As little as a body can be held by: a share of the stiffness of its contacts where all bear alike.
  const double force = load / std::cbrt(bodies * bodies);
  options.least_stiffness =
      0.2 * std::cbrt(force * spec.youngs_modulus * spec.youngs_modulus * mean_radius) / mean_radius;
  return options;
}

}  // namespace softgrain
