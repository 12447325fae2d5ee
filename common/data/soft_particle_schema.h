// The numbers of a soft particle, each described once: for scenes, cards, HDF5 files, comparisons and sentences. They
// and what is reported of packings as groups of HDF5 files: shared by measurements and law tables.
#pragma once

#include <span>
#include <vector>

#include "common/data/columns.h"
#include "common/data/measurements.h"
#include "common/io/hdf5_file.h"
#include "common/io/scene.h"

namespace softgrain {

/// A number of SoftParticleSpec.
struct SoftParticleNumber {
  const char* key;                  ///< in cards and HDF5 files
  const char* scene_key;            ///< in scenes and searches
  double SoftParticleSpec::*value;  ///< where it is, in SI units
  Unit unit;
  Range range;           ///< what files may hold
  Range drawn;           ///< what packings can be made with: the range of scenes and searches
  const char* symbol;    ///< as comments of tables and messages call it
  const char* meaning;   ///< comment in cards; empty: none
  const char* compared;  ///< what `compare` calls it; empty: it does not compare it
  const char* asked;     ///< what it means, said of the key in scenes
  bool always = false;   ///< always known, of an experiment too
};

/// All numbers, in the order of files.
std::span<const SoftParticleNumber> soft_particle_numbers();

/// The description of one of them.
const SoftParticleNumber& soft_particle_number(double SoftParticleSpec::*value);

/// The numbers that a range lets through, with ends that belong to it: an open end is the next number within.
Limits limits_of(const Range& range);

/// Writes the group "spec" with every field in SI, units in the attribute "units".
void write_spec(const h5::Group& root, const SoftParticleSpec& spec);
/// Reads it back. Throws IoError when a field is missing.
SoftParticleSpec read_spec(const h5::Group& root);

/// Writes the group "packings": one row per packing, radii [m] one after the other.
void write_packings(const h5::Group& root, const std::vector<PackingInfo>& packings);
/// Reads it back. Throws IoError when columns are missing or do not fit together.
std::vector<PackingInfo> read_packings(const h5::Group& root);

}  // namespace softgrain
