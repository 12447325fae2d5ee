// Types of atoms in LAMMPS: bodies of a kind and of a size class, so that lists reach no farther than they must.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "macrosim/macro_packing.h"

namespace softgrain::lammps {

struct BodyTypes {
  std::vector<std::int32_t> of;  ///< per body, from 1: solid classes first, then soft ones
  std::int32_t solid = 0;        ///< number of solid types
  std::int32_t soft = 0;
  std::vector<double> largest;  ///< radius per type, the first at [0] [m]

  [[nodiscard]] std::int32_t count() const { return solid + soft; }
  /// "1*3" as LAMMPS takes it; empty without such bodies.
  [[nodiscard]] std::string solid_range() const;
  [[nodiscard]] std::string soft_range() const;
};

/// Classes halve the radius, from the largest body of each kind down; empty ones have no type.
BodyTypes body_types(const MacroPacking& packing);

}  // namespace softgrain::lammps
