// The numbers of a soft particle, each described once: for scenes, cards, HDF5 files, comparisons and sentences.
#pragma once

#include <span>

#include "common/data/columns.h"
#include "common/data/measurements.h"
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

}  // namespace softgrain
