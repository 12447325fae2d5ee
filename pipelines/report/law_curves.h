// Curves of laws as figures draw them: the published fit and the Hertz line of a solid grain, which a measured force
// is set against, and the 95 % band of a fitted law.
#pragma once

#include <optional>
#include <vector>

#include "common/data/law_band.h"
#include "common/data/law_card.h"
#include "common/data/measurements.h"

namespace softgrain::report {

/// The published normal law of a soft particle against a plane [SP 1.5], in newtons, for E = 5e5 Pa and Rs = 0.016 m.
namespace published_soft_solid {
inline constexpr double a = 73.669;
inline constexpr double b = 2.799;
inline constexpr double c = -0.035;
inline constexpr double delta = 0.065;
inline constexpr double youngs_modulus = 5.0e5;
inline constexpr double shell_radius = 0.016;
inline constexpr double poisson_ratio = 0.3;
inline constexpr double friction = 0.3;
inline constexpr double exponent = 3.5;
inline constexpr double polydispersity = 10.0;
}  // namespace published_soft_solid

/// The published law [N], scaled by E Rs^2 to another grain stiffness and shell radius (exact by dimensions for equal
/// nu, mu).
double published_normal_force(double overlap_ratio, const SoftParticleSpec& spec);

/// Hertz force [N] of a solid grain of radius Rs of the same material at the same total overlap hn = Delta Rs [SP 1.3]:
/// sqrt(R12) hn^(3/2) / D, D = 3/4 * 2 (1 - nu^2)/E; R12 = Rs against a plane, Rs/2 for two equal grains.
double hertz_force(double overlap_ratio, const SoftParticleSpec& spec, PairKind kind);

/// Band that was read with the card when it is there, else from the covariance of the parameters by linearised error
/// propagation; empty when neither exists.
std::optional<LawBand> law_band(const PairLaw& law, LawPart part);

/// n values evenly spread over [low, high].
std::vector<double> spread(double low, double high, int n);

}  // namespace softgrain::report
