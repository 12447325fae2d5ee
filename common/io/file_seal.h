// A checksum over every byte of a file, kept at its end. HDF5 itself guards headers and data sets, but neither long
// texts nor the tables that say where the pieces of a data set lie: a flipped bit there reads as other content.
#pragma once

#include <string>

namespace softgrain {

enum class Seal {
  none,   ///< the file ends without one: written by another program, or cut short
  whole,  ///< every byte is as it was written
  broken  ///< some byte is not
};

/// Adds the seal to a complete file that has none. HDF5 does not mind bytes beyond its own end. Throws IoError.
void seal_file(const std::string& path);

/// Reads the whole file. Throws IoError when it cannot be read.
[[nodiscard]] Seal check_seal(const std::string& path);

}  // namespace softgrain
