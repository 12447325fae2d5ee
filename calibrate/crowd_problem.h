// The least-squares problems behind a crowd law: which parameters, which configurations, which weights.
#pragma once

#include <string>
#include <vector>

#include "calibrate/crowd_fit.h"
#include "calibrate/crowd_states.h"
#include "calibrate/least_squares.h"

namespace softgrain {

/// Which configurations a fit looks at.
using StateSelection = std::vector<const CrowdStates*>;

/// (law - mean)/sigma of all loading states and neighbours, sigma^2 = error^2 + (eps F)^2 + (eps F_largest/10)^2; every
/// configuration counts alike, however many neighbours it has.
std::vector<double> crowd_residuals(const CrowdModel& model, const StateSelection& selection, double discrepancy);

/// Root mean square of (law - mean) over that of the mean, loading states.
double crowd_error(const CrowdModel& model, const CrowdStates& states);

/// States of a configuration in which every overlap has only grown so far: a law without memory speaks of these.
std::vector<const CrowdState*> loading_states(const CrowdStates& states);

/// Parameters of the planes: ln a, b, delta and the coupling that the form has.
LeastSquaresFit fit_planes(CrowdModel& model, const StateSelection& selection, double discrepancy, bool thorough);

/// Weights per ratio and one exponent of solid or soft neighbours; `ratios` ascending (soft: of |ln ratio|).
/// `thorough`: every strategy when the first one does not come to a minimum.
LeastSquaresFit fit_partners(CrowdModel& model, PartnerKind kind, const std::vector<double>& ratios,
                             const StateSelection& selection, double discrepancy, bool thorough);

}  // namespace softgrain
