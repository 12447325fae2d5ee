#include "common/io/text_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include "common/core/error.h"
#include "common/io/atomic_rename.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;

/// True when all of `text` is written; errno tells why not.
bool write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

void write_file(const std::string& path, const std::string& text) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) throw FileTrouble(path + ": cannot be created: " + system_message());
  const bool good = write_all(descriptor, text);
  const std::string reason = system_message();
  const bool closed = ::close(descriptor) == 0;
  if (!good || !closed) throw FileTrouble(path + ": cannot be written: " + (good ? system_message() : reason));
}

}  // namespace

void write_text_atomic(const std::string& path, const std::string& text) {
  try {
    write_file(temporary_name(path), text);
    rename_into_place(path);
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary_name(path), ignored);
    throw;
  }
}

std::string read_text(const std::string& path) {
  std::error_code trouble;
  const fs::file_status status = fs::status(path, trouble);
  if (status.type() == fs::file_type::not_found) throw FileTrouble(path + ": no such file");
  if (fs::is_directory(status)) throw FileTrouble(path + ": is a directory, not a file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw FileTrouble(path + ": cannot be read: " + system_message());
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) throw FileTrouble(path + ": reading failed: " + system_message());
  return text;
}

void require_writable_directory(const std::string& path) {
  std::error_code trouble;
  fs::create_directories(path, trouble);
  if (trouble) throw FileTrouble(path + ": the directory cannot be made: " + trouble.message());
  if (!fs::is_directory(path, trouble)) throw FileTrouble(path + ": is not a directory");
  if (const int nameless = ::open(path.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666); nameless >= 0) {
    const bool good = write_all(nameless, "test\n");
    const std::string reason = system_message();
    ::close(nameless);
    if (!good) throw FileTrouble(path + ": cannot be written: " + reason);
    return;
  }
  // Not every file system knows files without a name; one with a name is left behind when the process is killed now.
  const std::string probe = path + "/.write-test-" + std::to_string(::getpid());
  write_file(probe, "test\n");
  fs::remove(probe, trouble);
}

}  // namespace softgrain
