// What keeps result files whole: a checksum at their end, the last step of atomic writes, one run at a time in a
// directory.
#pragma once

#include <string>

namespace softgrain {

/// A checksum over every byte of a file, kept at its end. HDF5 itself guards headers and data sets, but neither long
/// texts nor the tables that say where the pieces of a data set lie: a flipped bit there reads as other content.
enum class Seal {
  none,   ///< the file ends without one: written by another program, or cut short
  whole,  ///< every byte is as it was written
  broken  ///< some byte is not
};

/// Adds the seal to a complete file that has none. HDF5 does not mind bytes beyond its own end. Throws IoError.
void seal_file(const std::string& path);

/// Reads the whole file. Throws IoError when it cannot be read.
[[nodiscard]] Seal check_seal(const std::string& path);

// The last step of every atomic write: a complete temporary file takes the name of the result.

/// Name of the temporary file behind `path`; in the same directory, so that renaming is atomic.
inline std::string temporary_name(const std::string& path) { return path + ".tmp"; }

/// Flushes `temporary_name(path)` to disk and renames it to `path`; at no moment is there no file under `path` once
/// there was one. With `keep_previous` the old file stays as `path + ".previous"`. Throws IoError.
void rename_into_place(const std::string& path, bool keep_previous = false);

/// "disk full" and the like, for messages: the text of the current errno.
std::string system_message();

// One run at a time in a directory.

/// Holds DIR/.lock while it lives. The kernel lets go of it when the process ends, however that happens; the file
/// itself stays, as removing it would let two runs each hold a file of that name. Over NFS the lock reaches as far as
/// the server's lock service; where there is none, or the file system knows no locks, nothing is held and nothing said.
class DirectoryLock {
 public:
  /// Throws IoError when another process (or another run of this one) holds the directory, or when the file cannot
  /// be made.
  explicit DirectoryLock(const std::string& directory);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace softgrain
