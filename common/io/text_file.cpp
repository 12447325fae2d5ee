#include "common/io/text_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>

#include "common/core/error.h"
#include "common/io/file_safety.h"
#include "common/io/interrupt.h"

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

/// Waits a little for whoever reads at the other end of a pipe. Throws Interrupted when a signal came meanwhile.
bool has_room(int descriptor) {
  constexpr int kPatience = 200;  // milliseconds
  pollfd stream{descriptor, POLLOUT, 0};
  const int ready = ::poll(&stream, 1, kPatience);
  if (ready > 0 || (ready < 0 && errno != EINTR)) return true;  // what is wrong with it, writing will tell
  if (interrupt_requested()) throw Interrupted("stopped by a signal while standard output was not read");
  return false;
}

/// `shown`: the path in messages.
void write_file(const std::string& path, const std::string& text, const std::string& shown) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor < 0) throw IoError(shown + ": cannot be created: " + system_message());
  const bool good = write_all(descriptor, text);
  const std::string reason = system_message();
  const bool closed = ::close(descriptor) == 0;
  if (!good || !closed) throw IoError(shown + ": cannot be written: " + (good ? system_message() : reason));
}

/// What a path names that is no plain file; empty for one.
const char* other_than_file(fs::file_type type) {
  switch (type) {
    case fs::file_type::directory:
      return "a directory";
    case fs::file_type::fifo:
      return "a pipe";
    case fs::file_type::socket:
      return "a socket";
    case fs::file_type::character:
    case fs::file_type::block:
      return "a device";
    default:
      return "";
  }
}

}  // namespace

void write_standard_output(std::string_view text) {
  bool good = std::fflush(stdout) == 0;  // what was printed before comes first
  while (good && !text.empty()) {
    if (!has_room(STDOUT_FILENO)) continue;
    const std::string_view piece = text.substr(0, PIPE_BUF);  // so much never waits where there is room
    good = write_all(STDOUT_FILENO, piece);
    text.remove_prefix(piece.size());
  }
  if (!good) throw IoError("standard output: cannot be written: " + system_message());
}

void require_readable_file(const std::string& path) {
  std::error_code trouble;
  const fs::file_status status = fs::status(path, trouble);
  if (status.type() == fs::file_type::not_found) throw IoError(path + ": no such file");
  const std::string other = other_than_file(status.type());
  if (!other.empty()) throw IoError(path + ": is " + other + ", not a file");
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) throw IoError(path + ": cannot be read: " + system_message());
  char first = 0;
  const bool good = ::read(descriptor, &first, 1) >= 0;
  const std::string reason = system_message();
  ::close(descriptor);
  if (!good) throw IoError(path + ": cannot be read: " + reason);
}

void require_no_pipe(const std::string& path) {
  std::error_code trouble;
  if (fs::is_fifo(fs::status(path, trouble))) throw IoError(path + ": is a pipe, not a file");
}

std::string trimmed(const std::string& text) {
  constexpr const char* kSpace = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kSpace);
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

void require_folder_of(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().string();
  std::error_code trouble;
  if (folder.empty() || fs::is_directory(folder, trouble)) return;
  throw IoError(fs::exists(folder, trouble)
                    ? fmt::format("{}: {} is no folder", path, folder)
                    : fmt::format("{}: there is no folder {}; make it first, or choose another place", path, folder));
}

void write_text_atomic(const std::string& path, const std::string& text) {
  try {
    require_folder_of(path);
    write_file(temporary_name(path), text, path);
    rename_into_place(path);
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary_name(path), ignored);
    throw;
  }
}

std::string read_text(const std::string& path) {
  require_readable_file(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw IoError(path + ": cannot be read: " + system_message());
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (file.bad()) throw IoError(path + ": reading failed: " + system_message());
  return text;
}

void require_writable_directory(const std::string& path) {
  std::error_code trouble;
  fs::create_directories(path, trouble);
  if (trouble) throw IoError(path + ": the directory cannot be made: " + trouble.message());
  if (!fs::is_directory(path, trouble)) throw IoError(path + ": is not a directory");
  if (const int nameless = ::open(path.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666); nameless >= 0) {
    const bool good = write_all(nameless, "test\n");
    const std::string reason = system_message();
    ::close(nameless);
    if (!good) throw IoError(path + ": cannot be written: " + reason);
    return;
  }
  // Not every file system knows files without a name; one with a name is left behind when the process is killed now.
  const std::string probe = path + "/.write-test-" + std::to_string(::getpid());
  write_file(probe, "test\n", path);
  fs::remove(probe, trouble);
}

std::string short_hash(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3U;
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace softgrain
