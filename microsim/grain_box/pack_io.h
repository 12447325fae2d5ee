// A grain pack between plain walls (no symmetry planes, no gravity) to and from an HDF5 group, bit for bit.
#pragma once

#include "common/io/hdf5_file.h"
#include "common/statics/grain_pack.h"

namespace softgrain {

void write_pack(const h5::Group& group, const GrainPack& pack);
/// Throws FileTrouble when lengths or indices do not fit each other.
[[nodiscard]] GrainPack read_pack(const h5::Group& group);

}  // namespace softgrain
