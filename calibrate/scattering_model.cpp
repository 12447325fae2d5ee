#include "calibrate/scattering_model.h"

#include <gsl/gsl_sf_gamma.h>

#include <cmath>
#include <numbers>

#include "common/core/limits.h"

namespace softgrain {

namespace {

/// 2F1(a, b; c; y) by its series, for 0 <= y <= 1/2 where each term is about half the one before.
double hypergeometric(double a, double b, double c, double y) {
  double term = 1.0;
  double sum = 1.0;
  for (int n = 0; n < 200 && std::abs(term) > 1e-17 * std::abs(sum); ++n) {
    term *= (a + n) * (b + n) / ((c + n) * (1.0 + n)) * y;
    sum += term;
  }
  return sum;
}

}  // namespace

double fractal_decay(double dimension, double x) {
  if (!(dimension > 0.0) || !(x >= 0.0) || !std::isfinite(x)) return kNaN;
  // Pfaff: 2F1(a, b; 1; z) = (1-z)^-b 2F1(b, 1-a; 1; y) with y = z/(z-1) in [0, 1). Above 1/2 the formula that connects
  // y with 1-y: 1 - b - (1-a) = a - b = 1/2, never an integer, so it holds for every dF.
  const double b = 0.5 * dimension;
  const double q = 0.5 * (1.0 - dimension);  // 1 - a
  const double rest = 1.0 / (1.0 + x * x);   // 1 - y
  const double scale = std::pow(rest, b);
  if (rest >= 0.5) return scale * hypergeometric(b, q, 1.0, 1.0 - rest);
  const double root_pi = std::sqrt(std::numbers::pi);  // Gamma(1/2); Gamma(-1/2) = -2 sqrt(pi)
  const double even = gsl_sf_gammainv(1.0 - b) * gsl_sf_gammainv(1.0 - q) * hypergeometric(b, q, 0.5, rest);
  const double odd = gsl_sf_gammainv(b) * gsl_sf_gammainv(q) * hypergeometric(1.0 - b, 1.0 - q, 1.5, rest);
  return scale * root_pi * (even - 2.0 * std::sqrt(rest) * odd);
}

double scattering_intensity(const ScatteringModel& m, double k) {
  return m.background + m.amplitude * fractal_decay(m.dimension, m.length * k);
}

double scattering_lower_length(const ScatteringModel& m, double solid_fraction) {
  if (m.dimension == 2.0) return kNaN;
  const double ratio = 2.0 * std::numbers::pi * solid_fraction * std::tgamma(m.dimension) *
                       std::pow(m.length, m.dimension) / m.amplitude;
  return std::pow(ratio, 1.0 / (m.dimension - 2.0));
}

}  // namespace softgrain
