// Size distributions as a scene writes them.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>

#include "common/io/scene.h"
#include "common/packing/grading.h"
#include "common/packing/sieve_table.h"

namespace softgrain {

/// Reads a table with `form` and its keys: "power-law" (exponent, radius_min, radius_max), "fuller" (exponent q),
/// "log-normal" (radius_median, geometric_deviation), "classes" ([[class]]: radius or radius_min, radius_max, exponent;
/// volume_share), "sieve-curve" (file with column, unit, smallest, largest, or
/// openings and passing), "list" (radii and counts, or file). Files are looked
/// for in the folder of the scene. Throws InputError with file and line, IoError.
Grading read_grading(const SceneTable& table, int dimension = 3);

/// What Grading::text gave a file. Throws IoError.
Grading stored_grading(const std::string& text, int dimension = 3);

/// The table `key` of `table`, if there is one; keys that say the same another way are refused beside it. Within
/// Scene::read mistakes are noted, and none comes back.
std::optional<Grading> read_sizes(const SceneTable& table, const Key& key, std::initializer_list<const char*> instead,
                                  int dimension = 3);

/// The keys that go with the file of a sieve curve: column, unit, smallest, largest.
SieveOptions read_sieve_options(const SceneTable& table);

/// Radii as CSV: a column "radius [mm]" or "diameter [mm]", and "count" (number, frequency, n) of grains of each, one
/// where it is absent. Throws InputError, IoError.
Grading read_radii(const std::string& path, int dimension = 3);

}  // namespace softgrain
