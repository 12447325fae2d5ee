// Time step from stiffness and mass.
#pragma once

#include "common/system.h"

namespace softgrain {

/// The contact that sets the step.
struct StepLimit {
  double natural_time = 0.0;  ///< smallest sqrt(m/k) over bodies and laws [s]
  Slot body = -1;             ///< the body that sets it
  std::int32_t law = -1;      ///< the law that sets it
  double stiffness = 0.0;     ///< k [N/m]
};

/// sqrt(m/k) of the lightest, stiffest pairing: for every grain and every law its material takes part in, k is the
/// tangent stiffness against an equal partner at an overlap of `overlap_ratio` of its radius (soft contacts: at Delta =
/// 0.35; cohesive disks: the stiffest of their springs and of the slope of the attraction). A stable step is a fraction
/// of it: 0.2 is as good as 0.05 in soft-particle measurements, 0.4 is biased by 7-16 %.
template <int D>
StepLimit step_limit(const System<D>& system, double overlap_ratio = 0.05);

/// Largest fraction of StepLimit::natural_time that is accepted for a step.
inline constexpr double kLargestStepFraction = 0.6;

}  // namespace softgrain
