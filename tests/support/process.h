// The built program as a process of its own: started, watched, and ended by a signal.
#pragma once

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace softgrain::test {

/// Starts the program with these arguments, its output discarded. `in_child` runs in the new process before.
inline pid_t start_program(const std::vector<std::string>& arguments, const std::function<void()>& in_child = {}) {
  std::vector<char*> words{const_cast<char*>(SOFTGRAIN_PROGRAM)};
  for (const std::string& a : arguments) words.push_back(const_cast<char*>(a.c_str()));
  words.push_back(nullptr);
  const pid_t child = ::fork();
  if (child != 0) return child;
  const int quiet = ::open("/dev/null", O_WRONLY);
  ::dup2(quiet, STDOUT_FILENO);
  ::dup2(quiet, STDERR_FILENO);
  if (in_child) in_child();
  ::execv(SOFTGRAIN_PROGRAM, words.data());
  ::_exit(127);
}

/// Waits until `ready` says so, then sends `signal`; a program that ends before is left alone. Returns the wait status.
inline int signal_when(pid_t child, const std::function<bool()>& ready, int signal) {
  int status = 0;
  while (!ready()) {
    if (::waitpid(child, &status, WNOHANG) == child) return status;
    ::usleep(1000);
  }
  ::kill(child, signal);
  ::waitpid(child, &status, 0);
  return status;
}

/// Wall time after which a program hangs, on any machine and beside any other work.
inline constexpr std::chrono::seconds kLongestWait{900};

/// Processor time that a running program has used so far, all threads together [s]; 0 when there is none.
inline double processor_seconds(pid_t child) {
  clockid_t clock{};
  timespec used{};
  if (::clock_getcpuclockid(child, &clock) != 0 || ::clock_gettime(clock, &used) != 0) return 0.0;
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

inline double processor_seconds(const rusage& used) {
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// Sends `signal` when the program has used so many seconds of processor time: then it is as far on a busy machine as
/// on an idle one. One that uses none, as it waits for something, is signalled all the same in the end.
inline int signal_after(pid_t child, double seconds, int signal) {
  const auto end = std::chrono::steady_clock::now() + kLongestWait;
  return signal_when(
      child, [=] { return processor_seconds(child) >= seconds || std::chrono::steady_clock::now() >= end; }, signal);
}

/// A program that was ended by a signal.
struct Signalled {
  int status = 0;
  double after = 0.0;  ///< processor time that it used after the signal [s]
};

/// As signal_after.
inline Signalled signalled_after(pid_t child, double seconds, int signal) {
  const auto end = std::chrono::steady_clock::now() + kLongestWait;
  Signalled out;
  rusage used{};
  while (processor_seconds(child) < seconds && std::chrono::steady_clock::now() < end) {
    if (::waitpid(child, &out.status, WNOHANG) == child) return out;
    ::usleep(1000);
  }
  const double before = processor_seconds(child);
  ::kill(child, signal);
  ::wait4(child, &out.status, 0, &used);
  out.after = processor_seconds(used) - before;
  return out;
}

inline int wait_for(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

inline bool ended_with(int wait_status, int exit_status) {
  return WIFEXITED(wait_status) && WEXITSTATUS(wait_status) == exit_status;
}

/// True when SIGINT met the program in the middle, after `ready`, so that it ended as an interrupted one. A program
/// that was quicker is started afresh, without what it left in `directory`; one that always is makes the test fail.
inline bool interrupted_in_the_middle(const std::function<pid_t()>& start, const std::function<bool()>& ready,
                                      const std::string& directory) {
  constexpr int kTries = 20;
  for (int k = 0; k < kTries; ++k) {
    std::filesystem::remove_all(directory);
    const int status = signal_when(start(), ready, SIGINT);
    if (ended_with(status, 130)) return true;
  }
  return false;
}

/// For start_program: standard error goes to a file.
inline std::function<void()> errors_to(const std::string& path) {
  return [path] {
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    ::dup2(file, STDERR_FILENO);
  };
}

}  // namespace softgrain::test
