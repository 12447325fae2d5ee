// Coarse and fine parts of a size distribution of spheres, and mixtures that have other shares of them.
#pragma once

#include <optional>
#include <vector>

#include "common/packing/grading.h"

namespace softgrain {

/// The grains from `low` to below `high`, with their shares of the volume of all; exact, whatever the form. Empty where
/// there are none.
std::vector<SizePiece> pieces_between(const Grading& grading, double low, double high);

/// Both together; the fines have this share of the volume, and each part keeps its own distribution. One part may be
/// empty when its share is 0. Throws InputError as Grading does.
Grading mixture_of(std::vector<SizePiece> coarse, std::vector<SizePiece> fines, double fines_share);

/// The sizes, or where there are none P(r) ~ r^-exponent up to `largest`, `ratio` times the smallest.
Grading sizes_or_power_law(const std::optional<Grading>& sizes, double exponent, double largest, double ratio);

}  // namespace softgrain
