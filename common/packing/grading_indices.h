// Numbers by which soil mechanics describes a size distribution.
#pragma once

#include "common/packing/grading.h"

namespace softgrain {

/// Diameter [m] that this share of the volume is below; of equal grains the nearest one. 0 < share < 1.
double diameter_passing(const Grading& grading, double share);

struct GradingIndices {
  double d10 = 0.0;  ///< diameter that 10 % of the volume are below [m]
  double d30 = 0.0;
  double d50 = 0.0;
  double d60 = 0.0;
  double cu = 0.0;                 ///< coefficient of uniformity, D60/D10
  double cc = 0.0;                 ///< coefficient of curvature, D30^2/(D60 D10)
  double fuller = 0.0;             ///< q of (D^q - Dmin^q)/(Dmax^q - Dmin^q) with least squares over ln D; 0: one size
  double fuller_difference = 0.0;  ///< largest difference of passing from that curve
};

/// Of spheres. The exponent is sought from 0.01 to 3, the range of the form "fuller".
GradingIndices grading_indices(const Grading& grading);

}  // namespace softgrain
