// The bytes of an input as a file with a path, for readers that want one (HDF5 refuses files without a name).
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace softgrain::fuzz {

/// In a directory of its own, in memory where the system has /dev/shm; removed at the end.
class InputFile {
 public:
  InputFile(const void* data, std::size_t size, const std::string& name = "input") {
    const std::filesystem::path memory("/dev/shm");
    const auto folder = std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
    directory_ = folder / ("fuzz-input-" + std::to_string(::getpid()));
    std::filesystem::create_directory(directory_);
    path_ = (directory_ / name).string();
    const int descriptor = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (descriptor < 0 || ::write(descriptor, data, size) != static_cast<ssize_t>(size)) std::abort();
    ::close(descriptor);
  }
  ~InputFile() {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::filesystem::path directory_;
  std::string path_;
};

}  // namespace softgrain::fuzz
