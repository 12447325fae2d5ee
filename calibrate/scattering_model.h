// Intensity scattered by a fractal of finite extent in the plane [CP 3.5].
#pragma once

namespace softgrain {

/// I(k) = c + A 2F1[(1+dF)/2, dF/2; 1; -xi^2 k^2], the Hankel transform of a density correlation r^(dF-2) exp(-r/xi)
/// plus a constant. A = Phi 2 pi l^2 Gamma(dF) (xi/l)^dF stands for the prefactor: l alone is ill-determined near
/// dF = 2. A falls as k^-dF for 1/xi << k.
struct ScatteringModel {
  double amplitude = 0.0;   ///< A = I(0) - c [length^2]
  double dimension = 0.0;   ///< dF, 0 to 2: fractal dimension
  double length = 0.0;      ///< xi: up to where the fractal reaches [length]
  double background = 0.0;  ///< c: uncorrelated part [length^2]
};

/// 2F1[(1+dF)/2, dF/2; 1; -x^2] for dF > 0 and any x = xi k >= 0; 1 at x = 0. Relative error below 1e-11 for dF in
/// [0.02, 3]. NaN outside the domain. (A library's 2F1 stops at arguments below -1 and, transformed, at some dF.)
double fractal_decay(double dimension, double x);

/// I(k).
double scattering_intensity(const ScatteringModel& model, double k);

/// A/(2 pi l^2 Gamma(dF) (xi/l)^dF) = Phi inverted for l: (2 pi Phi Gamma(dF) xi^dF/A)^(1/(dF-2)). NaN at dF = 2.
double scattering_lower_length(const ScatteringModel& model, double solid_fraction);

}  // namespace softgrain
