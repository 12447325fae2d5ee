// A packing of power-law grains in a spherical shell: random trials, largest first, then growth to contact [SP 1.2].
#pragma once

#include <cstdint>

#include "common/data/measurements.h"
#include "common/data/shell_packing.h"

namespace softgrain {

/// Generates packing number `index` of the run with this seed. Dimensionless: the same for every Rs and E.
/// Throws BadInput when no grain could be placed.
ShellPacking generate_shell_packing(const SoftParticleSpec& spec, std::uint64_t seed, std::uint64_t index);

/// What is reported of a packing; radii in metres for the spec's Rs.
PackingInfo describe(const ShellPacking& packing, const SoftParticleSpec& spec);

}  // namespace softgrain
