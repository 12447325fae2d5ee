// Closed forms that several cases are held against.
#pragma once

#include <cmath>
#include <numbers>

namespace softgrain::verification {

/// Hertz contact of two bodies: F = K h^(3/2).
struct HertzPair {
  double stiffness = 0.0;       ///< K = 4/3 E* sqrt(R12) [N/m^1.5]
  double effective_mass = 0.0;  ///< m12; of one body against a wall: its mass [kg]
};

/// 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 for two spheres of one material [Pa].
inline double effective_modulus(double youngs_modulus, double nu) { return 0.5 * youngs_modulus / (1.0 - nu * nu); }

inline double hertz_stiffness(double effective_modulus, double effective_radius) {
  return 4.0 / 3.0 * effective_modulus * std::sqrt(effective_radius);
}

inline double sphere_mass(double radius, double density) {
  return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * density;
}

/// Largest force and overlap, and duration, of an elastic impact.
struct ImpactNumbers {
  double force = 0.0;     ///< [N]
  double overlap = 0.0;   ///< [m]
  double duration = 0.0;  ///< [s]
};

/// Hertz: h = (5 m12 v^2/(4 K))^(2/5), T = 2 h/v int_0^1 dx/sqrt(1 - x^(5/2)) = (4/5) B(2/5, 1/2) h/v.
inline ImpactNumbers hertz_impact(const HertzPair& pair, double speed) {
  ImpactNumbers out;
  out.overlap = std::pow(1.25 * pair.effective_mass * speed * speed / pair.stiffness, 0.4);
  out.force = pair.stiffness * std::pow(out.overlap, 1.5);
  out.duration = 0.8 * std::beta(0.4, 0.5) * out.overlap / speed;
  return out;
}

}  // namespace softgrain::verification
