#include "common/io/atomic_rename.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "common/core/error.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;

/// fsync through a descriptor of its own; directories cannot be synchronised on every file system, files must be.
bool synchronise(const std::string& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool good = ::fsync(descriptor) == 0;
  const int reason = errno;
  ::close(descriptor);
  errno = reason;
  return good;
}

/// The old file gets a second name; where links are not supported it is renamed.
void keep_as_previous(const std::string& path) {
  std::error_code trouble;
  if (!fs::exists(path, trouble)) return;
  const std::string previous = path + ".previous";
  fs::remove(previous, trouble);
  fs::create_hard_link(path, previous, trouble);
  if (trouble) fs::rename(path, previous, trouble);
  if (trouble) throw IoError(previous + ": the old file cannot be kept: " + trouble.message());
}

}  // namespace

std::string system_message() { return std::generic_category().message(errno); }

void rename_into_place(const std::string& path, bool keep_previous) {
  const std::string temporary = temporary_name(path);
  if (!synchronise(temporary, O_RDWR)) throw IoError(temporary + ": cannot be flushed to disk: " + system_message());
  if (keep_previous) keep_as_previous(path);
  if (std::rename(temporary.c_str(), path.c_str()) != 0)
    throw IoError(path + ": cannot be written: " + system_message());
  const std::string parent = fs::path(path).parent_path().string();
  (void)synchronise(parent.empty() ? "." : parent, O_RDONLY | O_DIRECTORY);
}

}  // namespace softgrain
