// What is reported of packings, as a group of an HDF5 file; shared by the kinds of measurements.
#pragma once

#include <vector>

#include "common/data/measurements.h"
#include "common/io/hdf5_file.h"

namespace softgrain {

/// Writes the group "packings": one row per packing, radii [m] one after the other.
void write_packings(const h5::Group& root, const std::vector<PackingInfo>& packings);
/// Reads it back. Throws FileTrouble when columns are missing or do not fit together.
std::vector<PackingInfo> read_packings(const h5::Group& root);

}  // namespace softgrain
