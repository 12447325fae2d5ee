// The exact joint fit of threshold laws, kink and all, and the covariance of what it finds.
#pragma once

#include <array>
#include <vector>

#include "calibrate/threshold_model.h"

namespace softgrain {

struct JointFit {
  JointParameters parameters;
  LeastSquaresFit fit;          ///< fit over [delta, A_j, b_j of each present curve]; covariance in units of sigma
  bool delta_at_zero = false;   ///< the threshold ran to its lower bound
  bool delta_at_limit = false;  ///< the threshold ran to its upper bound
  std::array<bool, kLawCurves> exponent_at_bound{};
};

/// Minimises sum_j sum_k n_jk [(mean_jk - F_j(D_k))/sigma_jk]^2; by the constancy of sigma and F over packings this is
/// the fit to all single packings. The residual has a kink where delta passes a measured Delta, so each interval
/// between neighbouring Deltas is fitted as a smooth problem with delta bounded to it, and the best interval wins:
/// exact, and no start can miss it. `delta_limit` bounds delta from above; 0 fixes delta = 0, the plain power law.
JointFit fit_joint(const FitCurves& curves, double delta_limit);

/// Joint fit from a known neighbour: it starts in the interval of `from` and walks on while delta runs into the
/// interval's end. The bootstrap uses it.
JointFit refit_joint(const FitCurves& curves, double delta_limit, const JointParameters& from);

/// Cluster-robust covariance of law_parameters(), packings being the clusters: H^-1 [G/(G-1) sum_g s_g s_g^T] H^-1, s_g
/// the score of packing g. Points of one packing move together, which (J^T J)^-1 alone would ignore. 7 x 7 row-major.
std::vector<double> packing_covariance(const JointFit& joint, const FitCurves& curves,
                                       const std::array<const CurveSamples*, kLawCurves>& samples);

}  // namespace softgrain
