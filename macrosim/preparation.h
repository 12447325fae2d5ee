// How the bodies of a macro scene get into their box: random places, then frictionless compaction as hard grains.
#pragma once

#include <cstdint>
#include <vector>

#include "macrosim/macro_packing.h"
#include "macrosim/macro_spec.h"

namespace softgrain {

/// Inverse cumulative distribution of P(r) ~ r^-b on [rmax/polydispersity, rmax] at u in (0, 1).
double power_law_radius(double exponent, double rmax, double polydispersity, double u);

/// At random places of a cube that they fill to `fraction`, largest first, without overlap; when so few bodies that
/// walls are near find no place, in a larger one. Throws NotUsable.
MacroPacking place_loosely(std::vector<MacroBody> bodies, std::uint64_t seed, std::uint64_t sample,
                           double fraction = 0.30);

/// Frictionless isotropic compaction of all bodies as hard grains until the wall pressure reaches start_pressure * E.
/// Throws NotUsable when it does not jam.
void bring_into_touch(const MacroSpec& spec, MacroPacking& packing);

/// The same, but only up to a share of the box filled with bodies, below jamming. Throws BadInput when they jam before.
void compact_to_fraction(const MacroSpec& spec, MacroPacking& packing, double fraction);

}  // namespace softgrain
