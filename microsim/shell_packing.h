// A packing of power-law grains in a spherical shell: random trials, largest first, then growth to contact [SP 1.2].
#pragma once

#include <cstdint>
#include <vector>

#include "common/core/vec.h"
#include "common/data/measurements.h"

namespace softgrain {

/// Grains inside a unit shell (radius 1, centre at the origin), largest first.
struct ShellPacking {
  std::uint64_t seed = 0;
  std::vector<Vec3> position;
  std::vector<double> radius;

  [[nodiscard]] double solid_fraction() const;
};

/// Generates packing number `index` of the run with this seed. Dimensionless: the same for every Rs and E.
/// Throws BadInput when no grain could be placed.
ShellPacking generate_shell_packing(const SoftParticleSpec& spec, std::uint64_t seed, std::uint64_t index);

/// What is reported of a packing; radii in metres for the spec's Rs.
PackingInfo describe(const ShellPacking& packing, const SoftParticleSpec& spec);

}  // namespace softgrain
