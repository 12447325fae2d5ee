// The run of one pack: the loose arrangement that it starts from and its compaction up to the length at which stress
// first appears, then generation (a) and (b), then loading [QS 2.3].
#pragma once

#include <cstdint>
#include <vector>

#include "common/state/run_control.h"
#include "common/statics/grain_pack.h"
#include "microsim/grain_box/record.h"
#include "microsim/grain_box/spec.h"

namespace softgrain {

/// Radii of a pack, largest first. Random numbers are keyed by the seed and spec.arrangement, not by their sum: no
/// arrangement of one seed is one of another seed.
std::vector<double> drawn_radii(const GrainBoxSpec& spec, std::uint64_t seed);

/// Grains at random places without overlap inside a box from the origin to `lengths`; elasticity drawn. Walls in the
/// order -x +x -y +y -z +z, everything frictionless. Random numbers are keyed as those of drawn_radii. Throws
/// InputError when the grains do not fit.
GrainPack make_loose_pack(const GrainBoxSpec& spec, std::uint64_t seed);

struct CompactedPack {
  GrainPack pack;            ///< pressed a little, contacts refreshed
  Vec3 stress_free_lengths;  ///< sides of the last box without stress [m]: strain is measured from here
  std::int64_t steps = 0;
  std::int64_t loop_passes = 0;
};

/// Shrinks the box isotropically, relaxing without friction (dynamic relaxation: a loose pack is floppy), in steps that
/// are halved whenever stress appears, until the wall stress exceeds kFirstStress E at a step of kLastStep; then on to
/// a fifth of the first pressure of the generation. Throws UnusableResult when the pack does not jam, Interrupted.
CompactedPack compact_until_stress(const GrainBoxSpec& spec, GrainPack loose);

inline constexpr double kFirstStress = 1e-6;  ///< mean wall stress over mean E that counts as stress
inline constexpr double kLastStep = 1e-4;     ///< strain

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
