// One run at a time in a directory.
#pragma once

#include <string>

namespace softgrain {

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
