// How a packing of a span that nobody can resolve answers to a test, from packings of smaller ones in the same test.
#pragma once

#include <string>
#include <vector>

#include "calibrate/onset_extrapolation.h"

namespace softgrain {

/// One sample in a test, at the points of the test. All samples have the same points.
struct ResponseCurve {
  std::string group;             ///< group of the equation of state
  std::vector<double> volume;    ///< volume of the cell over that at the start
  std::vector<double> pressure;  ///< p/E
  std::vector<double> ratio;     ///< lateral stress over axial stress
  std::vector<double> deviator;  ///< q/p
};

struct ResponseOptions {
  StateForm form = StateForm::porosity;
  double start_pressure = 1e-4;  ///< pressure at the start, over E
  std::uint64_t seed = 1;
  OnsetOptions onset;
};

struct ResponsePrediction {
  bool usable = false;
  std::string message = "not run";
  OnsetExtrapolation onset;
  Estimate solid_fraction;                                   ///< solid fraction at the start
  std::vector<Estimate> pressure, axial, lateral, deviator;  ///< estimates at every point; the first three over E
};

/// Onset phi_J from extrapolate_onset; at the start x0 = (p0/KE)^(1/n) beyond it; from there phi = phi0 V0/V and p by
/// the equation of state, times what pressures of small spans are of it at that point (a packing
/// at rest yields more to new strain than one on its way, differently in each test); axial = 3 p/(1 + 2 k), lateral = k
/// axial. ln of that factor, k and q/p are means over samples of a group, and go on in two ways: they stay what they
/// are at the largest span, or go on along the straight line through the groups over phi_J. Intervals: every replicate
/// of `fit` with samples of the groups drawn anew, both ways, every form of onset that the data allow; from the lowest
/// to the highest of their 95 %. The value is the mean of their medians. Throws InputError as extrapolate_onset does,
/// and for curves of other points or unknown groups. Not usable: no onset.
ResponsePrediction predict_response(const StateFit& fit, const std::vector<ResponseCurve>& curves, double span,
                                    const ResponseOptions& options);

/// phi_J that comes closest to a curve, K and n given.
double fitted_onset(StateForm form, double modulus, double exponent, const StateCurve& curve);

}  // namespace softgrain
