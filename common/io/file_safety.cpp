#include "common/io/file_safety.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>
#include <vector>

#include "common/core/error.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

constexpr std::array<char, 8> kMark{'s', 'g', 's', 'e', 'a', 'l', '0', '2'};
constexpr std::size_t kSealBytes = kMark.size() + sizeof(std::uint64_t);
constexpr std::size_t kBlock = std::size_t{1} << 20;

struct Closer {
  void operator()(std::FILE* file) const { (void)std::fclose(file); }
};
using Stream = std::unique_ptr<std::FILE, Closer>;

Stream open_stream(const std::string& path, const char* mode) {
  Stream file(std::fopen(path.c_str(), mode));
  if (!file) throw IoError(path + ": cannot be opened: " + system_message());
  return file;
}

/// CRC-32 of the first `length` bytes beside that length. Throws IoError.
std::uint64_t sum_of(std::FILE* file, std::uint64_t length, const std::string& path) {
  uLong sum = crc32_z(0, nullptr, 0);
  std::vector<unsigned char> block(kBlock);
  std::rewind(file);
  for (std::uint64_t left = length; left > 0;) {
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(left, kBlock));
    if (std::fread(block.data(), 1, wanted, file) != wanted)
      throw IoError(path + ": cannot be read: " + system_message());
    sum = crc32_z(sum, block.data(), wanted);
    left -= wanted;
  }
  return length << 32U | static_cast<std::uint64_t>(sum);
}

std::uint64_t length_of(std::FILE* file, const std::string& path) {
  if (std::fseek(file, 0, SEEK_END) != 0) throw IoError(path + ": cannot be read: " + system_message());
  return static_cast<std::uint64_t>(std::ftell(file));
}

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

void seal_file(const std::string& path) {
  const Stream file = open_stream(path, "r+b");
  const std::uint64_t sum = sum_of(file.get(), length_of(file.get(), path), path);
  std::array<char, kSealBytes> seal{};
  std::memcpy(seal.data(), kMark.data(), kMark.size());
  std::memcpy(seal.data() + kMark.size(), &sum, sizeof sum);
  const bool written = std::fseek(file.get(), 0, SEEK_END) == 0 &&
                       std::fwrite(seal.data(), 1, seal.size(), file.get()) == seal.size() &&
                       std::fflush(file.get()) == 0;
  if (!written) throw IoError(path + ": cannot be written: " + system_message());
}

Seal check_seal(const std::string& path) {
  require_readable_file(path);  // a pipe would keep the program waiting for ever
  const Stream file = open_stream(path, "rb");
  const std::uint64_t length = length_of(file.get(), path);
  if (length < kSealBytes) return Seal::none;
  std::array<char, kSealBytes> seal{};
  if (std::fseek(file.get(), -static_cast<long>(kSealBytes), SEEK_END) != 0 ||
      std::fread(seal.data(), 1, seal.size(), file.get()) != seal.size())
    throw IoError(path + ": cannot be read: " + system_message());
  if (std::memcmp(seal.data(), kMark.data(), kMark.size()) != 0) return Seal::none;
  std::uint64_t kept = 0;
  std::memcpy(&kept, seal.data() + kMark.size(), sizeof kept);
  return sum_of(file.get(), length - kSealBytes, path) == kept ? Seal::whole : Seal::broken;
}

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
