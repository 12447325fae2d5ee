// Starting states that are not prepared: kept by another run, or given as a file.
#pragma once

#include <cstdint>
#include <string>

#include "macrosim/macro_packing.h"

namespace softgrain {

/// Raised whenever the same key would give another packing: when random numbers, preparations or what a packing holds
/// change. The test of cached results holds the packings of this number.
inline constexpr int kPackingSchema = 3;

/// Everything that determines a prepared packing, as text.
std::string packing_key(const MacroSpec& spec, std::uint64_t seed, std::uint64_t sample);

/// A table of bodies as CSV: columns "x [m]", "y [m]", "z [m]", "r [m]" (or other lengths) and "kind", which is solid
/// or soft. The box in a comment "# box [mm] = x y z x y z" (any unit of length), its low and its high corner; without
/// it the tightest one. A periodic cell must be said. Other columns and other comments that name a value are refused.
/// Throws IoError, and InputError with line and column for what is no body, for a body outside the box and for two
/// that overlap by more than kGivenOverlap of the smaller radius.
MacroPacking read_packing_file(const std::string& path, Boundary boundary = Boundary::walls);

/// More than any test here presses bodies into each other at its start; soft particles that overlap by more would be
/// beyond the range of any measured law in most of their contacts.
inline constexpr double kGivenOverlap = 0.2;

}  // namespace softgrain
