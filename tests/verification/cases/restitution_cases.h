// Recovered restitution of normal impacts over restitution, size ratio and speed.
#pragma once

#include <string>

namespace softgrain::verification {

enum class NormalLaw { hertz, linear };

/// Two spheres, the second at rest with `ratio` times the radius; ratio 0: a plane.
struct RestitutionCase {
  NormalLaw law = NormalLaw::hertz;
  double restitution = 0.5;
  double ratio = 1.0;
  double speed = 1.0;               ///< [m/s]
  double phase = 0.5;               ///< share of a step that is over when the bodies touch
  double steps_per_impact = 400.0;  ///< of the duration of the elastic impact
};

std::string restitution_scene(const RestitutionCase& which);

/// Relative speed after over before.
double recovered_restitution(const RestitutionCase& which);

}  // namespace softgrain::verification
