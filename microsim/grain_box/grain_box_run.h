// The run of one pack: generation (a) and (b), then loading [QS 2.3].
#pragma once

#include "common/state/run_control.h"
#include "microsim/grain_box/record.h"

namespace softgrain {

/// Goes on from `state` (a fresh one starts at the beginning) to the end. Depends on spec, seed and state alone: a run
/// that was stopped and went on ends in the same bits. What cannot be done (an increment without equilibrium, a stress
/// out of reach, a pack that does not jam) ends the run: usable is false, everything before it is kept.
/// Progress is told after every equilibrium. Throws InputError, and Interrupted after saving.
[[nodiscard]] GrainBoxResult run_grain_box(const GrainBoxSpec& spec, std::uint64_t seed, GrainBoxState state,
                                           const RunControl<GrainBoxState>& control);

/// End of phase (b): over the last two windows of increments the mean sliding share changed by no more than
/// `saturation`, and the mean G of the later window is larger than that of the earlier one: sliding has saturated and G
/// grows. False with fewer than two windows of points of this phase.
[[nodiscard]] bool friction_phase_over(const std::vector<BoxPoint>& points, const GrainBoxGeneration& generation);

/// Increment of a programme at a strain since its start.
[[nodiscard]] double increment_at(const GrainBoxLoading& loading, double strain);

}  // namespace softgrain
