#include "common/io/directory_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "common/core/error.h"
#include "common/io/atomic_rename.h"

namespace softgrain {

namespace {

/// Who holds it, as it wrote there; empty when it has not yet.
std::string holder(int descriptor) {
  std::array<char, 32> text{};
  const ssize_t length = ::pread(descriptor, text.data(), text.size(), 0);
  std::string number;
  for (ssize_t k = 0;
       k < length && text[static_cast<std::size_t>(k)] >= '0' && text[static_cast<std::size_t>(k)] <= '9'; ++k)
    number += text[static_cast<std::size_t>(k)];
  return number.empty() ? "" : " (process " + number + ")";
}

/// Writes the number of this process, for the message that another run gets; nothing depends on it.
void sign(int descriptor) {
  const std::string text = std::to_string(::getpid()) + "\n";
  if (::ftruncate(descriptor, 0) == 0) (void)!::pwrite(descriptor, text.data(), text.size(), 0);
}

}  // namespace

DirectoryLock::DirectoryLock(const std::string& directory) {
  const std::string path = directory + "/.lock";
  descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw IoError(path + ": cannot be created: " + system_message());
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) {
    sign(descriptor_);
    return;
  }
  if (errno != EWOULDBLOCK) return;
  const std::string who = holder(descriptor_);
  ::close(descriptor_);
  descriptor_ = -1;
  throw IoError(directory + ": another run" + who +
                " is at work in this directory; wait for it to end, or choose another with --out");
}

DirectoryLock::~DirectoryLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace softgrain
