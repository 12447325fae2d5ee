#include "common/io/child_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "common/core/error.h"
#include "common/io/file_safety.h"
#include "common/io/interrupt.h"

namespace softgrain {

namespace {

constexpr useconds_t kLookEvery = 200'000;  ///< [us]

/// Runs the program in the forked process. Only calls that are safe between fork and exec are made. On failure it
/// reports the errno and exits.
[[noreturn]] void become(char* const* words, const char* directory, int log, pid_t parent, int report) {
  const auto fail = [&] {
    const int error = errno;
    [[maybe_unused]] const auto written = ::write(report, &error, sizeof error);
    ::_exit(127);
  };
  ::setpgid(0, 0);  // Ctrl-C of a terminal reaches us alone, and we pass it on
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) ::_exit(127);
  ::signal(SIGXFSZ, SIG_DFL);
  const int nothing = ::open("/dev/null", O_RDONLY);
  if (nothing < 0 || ::dup2(nothing, STDIN_FILENO) < 0 || ::dup2(log, STDOUT_FILENO) < 0 ||
      ::dup2(log, STDERR_FILENO) < 0 || ::chdir(directory) != 0)
    fail();
  ::execv(words[0], words);
  fail();
  ::_exit(127);
}

/// Waits for exec: what went wrong before it, 0 when nothing did.
int error_before_start(int report) {
  int error = 0;
  while (::read(report, &error, sizeof error) < 0 && errno == EINTR) {
  }
  return error;
}

/// Watches the child; ends it when we are asked to stop.
ChildEnd wait_for(pid_t child, const std::function<void()>& watch, double patience) {
  using Clock = std::chrono::steady_clock;
  ChildEnd end;
  Clock::time_point asked;
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) != child) {
    if (!end.interrupted && interrupt_requested()) {
      end.interrupted = true;
      asked = Clock::now();
      ::kill(-child, SIGTERM);
    } else if (end.interrupted && std::chrono::duration<double>(Clock::now() - asked).count() > patience) {
      ::kill(-child, SIGKILL);
    }
    watch();
    ::usleep(kLookEvery);
  }
  if (end.interrupted) ::kill(-child, SIGKILL);  // what it started and left behind
  if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
  if (WIFEXITED(status)) end.status = WEXITSTATUS(status);
  return end;
}

}  // namespace

ChildEnd run_child(const std::vector<std::string>& words, const std::string& directory, const std::string& log,
                   const std::function<void()>& watch, double patience) {
  const int log_file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (log_file < 0) throw IoError(log + ": cannot be written: " + system_message());
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  int report[2] = {-1, -1};
  if (::pipe2(report, O_CLOEXEC) != 0) throw IoError("a pipe cannot be made: " + system_message());
  const pid_t self = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) become(arguments.data(), directory.c_str(), log_file, self, report[1]);
  ::close(report[1]);
  ::close(log_file);
  if (child < 0) {
    ::close(report[0]);
    throw IoError(words[0] + ": cannot be started: " + system_message());
  }
  ::setpgid(child, child);  // whoever is first
  const int error = error_before_start(report[0]);
  ::close(report[0]);
  if (error != 0) {
    ::waitpid(child, nullptr, 0);
    throw IoError(words[0] + ": cannot be started: " + std::generic_category().message(error));
  }
  return wait_for(child, watch, patience);
}

bool is_program(const std::string& path) {
  std::error_code ignored;
  return ::access(path.c_str(), X_OK) == 0 && !std::filesystem::is_directory(path, ignored);
}

std::string find_in_path(const std::string& name) {
  const char* path = std::getenv("PATH");
  const std::string folders = path == nullptr ? "" : path;
  std::size_t begin = 0;
  while (begin <= folders.size()) {
    const std::size_t end = std::min(folders.find(':', begin), folders.size());
    const std::string file = (end > begin ? folders.substr(begin, end - begin) : ".") + "/" + name;
    if (is_program(file)) return file;
    begin = end + 1;
  }
  return "";
}

std::string own_program() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? "" : self.string();
}

std::string own_directory() { return std::filesystem::path(own_program()).parent_path().string(); }

}  // namespace softgrain
