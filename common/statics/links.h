// Pairs that may touch during an increment, with what their contact law needs, and the rule when to search again.
#pragma once

#include <cstdint>
#include <vector>

#include "common/statics/contact_law.h"
#include "common/statics/grain_pack.h"

namespace softgrain::statics {

/// Pairs in reach, sorted by (i, j); j >= grains: wall j - grains. Friction is stored only where a contact may have it.
struct Links {
  std::vector<std::int32_t> i;
  std::vector<std::int32_t> j;
  std::vector<NormalConstants> normal;
  std::vector<FrictionConstants> friction;  ///< empty: no contact of the pack has friction
  // Grain -> its links in ascending order, for the parallel gather.
  std::vector<std::int32_t> start;
  std::vector<std::int32_t> of_grain;
  // Positions at the search.
  std::vector<Vec3> searched_at;
  std::vector<Vec3> walls_at;

  [[nodiscard]] std::int32_t size() const { return static_cast<std::int32_t>(i.size()); }
};

/// Whether any contact of the pack can carry a tangential force.
bool has_friction(const GrainPack& pack);

/// Searches pairs at `positions`; the reference state comes from the contacts of `pack`. Throws InputError for arrays
/// of different length and values outside their range.
Links find_links(const GrainPack& pack, const std::vector<Vec3>& positions, const std::vector<Vec3>& wall_points);

/// True while no pair outside the list can have come into contact.
bool links_hold(const Links& links, const GrainPack& pack, const std::vector<Vec3>& positions,
                const std::vector<Vec3>& wall_points);

}  // namespace softgrain::statics
