// The loose arrangement a pack starts from, and its compaction up to the length at which stress first appears.
#pragma once

#include <cstdint>
#include <vector>

#include "common/statics/grain_pack.h"
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

}  // namespace softgrain
