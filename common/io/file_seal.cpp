#include "common/io/file_seal.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "common/core/error.h"
#include "common/io/atomic_rename.h"

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

}  // namespace softgrain
