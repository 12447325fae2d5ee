// Replicates of two fits of the equation of state that belong together: a packing that is in both scatters as one.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "calibrate/equation_of_state_fit.h"

namespace softgrain {

/// The curves of one run and their fit by fit_equation_of_state().
struct FittedCurves {
  std::vector<StateCurve> curves;  ///< one per sample; the group is the packing
  StateFit fit;
};

struct PairedFits {
  StateFit a;  ///< the fit of A, with replicates of which each belongs to that of the same number in `b`
  StateFit b;
  double degrees = 0.0;  ///< degrees of freedom of the scatter of replicates; below 1: errors are not known
};

/// Bootstrap of residuals (Efron and Tibshirani 1993, ch. 9, ISBN 0412042312) of two runs at once. The residual of a
/// sample is its curve phi(ln p) less the mean of its packing. A replicate adds to the curve of each sample a residual
/// drawn with replacement from all N samples of the G different packings, times sqrt(N/(N - G)), and moves ln K, n and
/// all phi_J by one Gauss-Newton step. `shared` gives packings that are in both (name in B: name in A). They count
/// once and have the same draws in both fits, so that they cancel in a difference as far as they act alike on both.
/// All other packings have draws of their own. Where a fit refuses one K for all packings, each has besides a K of its
/// own, drawn with the deviation of K between packings.
/// Degrees of freedom: N - G, where one K is refused G - 1 at most; 0 where one of the runs has no errors of its own.
/// Throws UnusableResult where the curves do not determine the numbers of a fit.
PairedFits replicates_together(const FittedCurves& a, const FittedCurves& b,
                               const std::map<std::string, std::string>& shared, const StateFitOptions& options);

}  // namespace softgrain
