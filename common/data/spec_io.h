// The specification of a soft particle as attributes of an HDF5 group, and what is reported of packings as a group:
// shared by measurements and law tables.
#pragma once

#include <vector>

#include "common/data/measurements.h"
#include "common/io/hdf5_file.h"

namespace softgrain {

/// Writes the group "spec" with every field in SI, units in the attribute "units".
void write_spec(const h5::Group& root, const SoftParticleSpec& spec);
/// Reads it back. Throws IoError when a field is missing.
SoftParticleSpec read_spec(const h5::Group& root);

/// Throws IoError unless the file is of this kind and of a schema that is known.
void require_format(const h5::Group& root, const std::string& format, const std::string& path);
/// Marks a file as such.
void write_format(const h5::Group& root, const std::string& format);

/// Writes the group "packings": one row per packing, radii [m] one after the other.
void write_packings(const h5::Group& root, const std::vector<PackingInfo>& packings);
/// Reads it back. Throws IoError when columns are missing or do not fit together.
std::vector<PackingInfo> read_packings(const h5::Group& root);

}  // namespace softgrain
