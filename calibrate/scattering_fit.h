// Fractal dimension and correlation length of a packing from the intensity that it scatters [CP 3.5].
#pragma once

#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "common/data/scattering_curve.h"

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

struct ScatteringFitOptions {
  double k_low = 0.0;  ///< fitted range of k [1/length]; 0: from the first bin on
  double k_high =
      std::numbers::pi;  ///< about pi/a, two diameters: beyond, the form factor of the disks bends the curve
  double disk = 1.0;     ///< largest diameter: a xi below it is reported
  /// Above 0: the amplitude is tied to it, A = Phi 2 pi l^2 Gamma(dF) (xi/l)^dF, and l, where the fractal begins, stays
  /// within the sizes of what it is made of, xi between the largest disk and half the cell, dF at 2 or below.
  double solid_fraction = 0.0;
  double lower_length_min = 0.25;  ///< smallest radius [length]
  double lower_length_max = 1.0;   ///< largest diameter [length]
  /// Largest c: that of disks at independent places (independent_intensity); infinite: any, also below 0. A finite one
  /// keeps c at 0 or above.
  double background_max = std::numeric_limits<double>::infinity();
  double cell_length = 0.0;  ///< shortest period: a xi beyond half of it is reported; 0: unknown
};

/// One fitted number.
struct ScatteringEstimate {
  double value = 0.0;
  double error = 0.0;  ///< standard error; of ln(value) times value for amplitude and length
  double low = 0.0;    ///< 95 % interval
  double high = 0.0;
};

struct ScatteringFit {
  bool usable = false;
  std::string reason = "not run";  ///< why it is not usable; empty when it is
  ScatteringModel model;           ///< best values, also when not usable (then not to be relied on); zero without a fit
  ScatteringEstimate amplitude;
  ScatteringEstimate dimension;
  ScatteringEstimate length;
  ScatteringEstimate background;
  ScatteringEstimate lower_length;  ///< l, where the amplitude is tied to it; else zero
  std::string bounded;              ///< numbers that ended at a bound; the errors of others take them as known
  double tie_cost = 0.0;            ///< above 0: the amplitude is free, since tying it to Phi would cost so much chi^2
  std::vector<double> covariance;   ///< 4 x 4 row-major of (ln A, dF, ln xi, c)
  double k_low = 0.0;               ///< first and last k that were fitted
  double k_high = 0.0;
  std::size_t bins = 0;
  double chi2_per_degree = 0.0;  ///< about 1 when the model holds; above 1 the errors have been widened by its root
};

/// Intensity of disks at places that do not know of each other, at k = 0: sum of squared areas over the area of the
/// cell, Phi <(pi d^2/4)^2>/<pi d^2/4> [length^2].
double independent_intensity(const std::vector<double>& diameters, double cell_area);

/// Least squares of ln I over the bins in [k_low, k_high]. A mode of a disordered density field has an exponentially
/// distributed intensity, so the mean of m independent ones is gamma-distributed: its logarithm has the bias
/// psi(m) - ln m and the deviation sqrt(psi'(m)), both exact, whatever the intensity. With them every residual has mean
/// 0 and deviation 1, the steep start of the curve weighs as much as its modes tell, and chi^2 judges the model. Errors
/// from the curvature; widened by sqrt(chi^2/degrees) (and Student's t) when that is above 1. Several starts.
/// Several curves are fitted with common parameters (samples of one ensemble). One curve of a cell of few xi hardly
/// tells amplitude, dF, xi and c apart: `solid_fraction` and `background_max` leave only what the disks allow. Of four
/// samples in cells of seven xi the deviation of dF from the truth is then two thirds of that with a free amplitude;
/// its 95 % intervals, which take a number at its bound as known, hold the truth in 16 of 20 cases. Where the tie costs
/// more chi^2 than chance explains (3.84), the amplitude is free after all (`tie_cost`). Not usable, with
/// the reason: fewer than 8 bins in the range, an intensity that is not positive and finite, no convergence, parameters
/// that the data do not determine, dF outside (0, 2], xi below the disks or beyond half the cell, an interval of dF
/// wider than 2, chi^2 per degree above 10. Throws InputError for options out of range.
ScatteringFit fit_scattering(const std::vector<ScatteringCurve>& curves, const ScatteringFitOptions& options = {});

/// Bins of several curves on the same edges put together, each with its modes: the mean intensity of an ensemble.
ScatteringCurve pooled_curve(const std::vector<ScatteringCurve>& curves, const std::vector<double>& edges);

}  // namespace softgrain
