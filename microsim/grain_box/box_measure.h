// What a pack between six planes shows: lengths, stresses on its walls, contacts per grain.
#pragma once

#include <cstdint>

#include "common/statics/grain_pack.h"

namespace softgrain {

/// Walls come in the order -x +x -y +y -z +z.
inline constexpr int kBoxWalls = 6;

[[nodiscard]] Vec3 box_lengths(const GrainPack& pack);
[[nodiscard]] double solid_volume(const GrainPack& pack);  ///< volume of all grains, overlaps counted twice [m^3]
[[nodiscard]] double solid_fraction(const GrainPack& pack);

/// Stress by wall forces over wall areas (of the box as it is), compression positive [Pa].
struct BoxStress {
  Vec3 normal{};           ///< per axis, mean of both walls
  double imbalance = 0.0;  ///< largest difference of opposite walls over their mean
  /// Shear stress by the first moment of the wall forces, sigma_ab = -(1/V) sum f_a (x - c)_b, of which the largest
  /// (sigma_ab + sigma_ba)/2 in magnitude; f on the grains, c the centre of the box.
  double shear = 0.0;
  /// Largest component of the moment of all wall forces about the centre, over V: 0 but for residuals and torsion.
  double moment = 0.0;
  [[nodiscard]] double mean() const { return (normal[0] + normal[1] + normal[2]) / 3.0; }
  /// sqrt(3 J2): |axial - lateral| when two stresses are equal.
  [[nodiscard]] double deviator() const;
};
[[nodiscard]] BoxStress box_stress(const GrainPack& pack);

struct ContactCounts {
  std::int64_t contacts = 0;          ///< contacts that carry force, of grains and walls
  std::int64_t sliding = 0;           ///< contacts with |Q| >= mu P in this state [QS 2.3]
  double coordination = 0.0;          ///< contacts per grain (a wall contact counts for one grain)
  double coordination_without = 0.0;  ///< contacts per grain without rattlers
  std::int64_t rattlers = 0;
  std::int64_t fewest = 0;  ///< contacts of any grain
  double mean_force = 0.0;  ///< mean normal force [N]
};
/// Rattlers have fewer than 4 contacts without friction, fewer than 2 with it; they are taken out until none is left.
[[nodiscard]] ContactCounts count_contacts(const GrainPack& pack);

/// Share of contacts whose |Q| at the end of an increment reaches (1 - 1e-6) mu P of its start, the limit within the
/// increment by the published rule. New contacts have no such limit and do not count as being at it. NaN without
/// friction. `before`: contacts at the start of the increment, sorted by (i, j).
[[nodiscard]] double share_at_start_limit(const std::vector<PackContact>& before, const GrainPack& after);

/// Contacts of every grain.
[[nodiscard]] std::vector<std::int32_t> contacts_per_grain(const GrainPack& pack);

/// Moves of the six walls that strain the box by dL = strain * reference, opposite walls alike.
[[nodiscard]] std::vector<Vec3> wall_moves(const Vec3& strain, const Vec3& reference);

}  // namespace softgrain
