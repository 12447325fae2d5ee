// Other programs as processes of their own, without a shell between; and where programs are.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace softgrain {

struct ChildEnd {
  int status = 0;            ///< exit status, when it ended by itself
  int signal = 0;            ///< signal that ended it; 0: none
  bool interrupted = false;  ///< a signal to this program made us end it
};

inline constexpr double kChildPatience = 5.0;  ///< time from SIGTERM to SIGKILL [s]

/// Runs `words` (the program with its path, then arguments) in `directory`, its standard output and standard error
/// going to the end of `log`. `watch` is called about five times a second. When this program is asked to stop
/// (common/io/interrupt.h), the child and all it started get SIGTERM, and SIGKILL should they not end within `patience`
/// [s]; when this program is killed, the child gets SIGTERM. Several threads may each run one, and wait for it. Throws
/// IoError when it cannot be started.
ChildEnd run_child(const std::vector<std::string>& words, const std::string& directory, const std::string& log,
                   const std::function<void()>& watch, double patience = kChildPatience);

/// Whether a file that may be executed is there.
bool is_program(const std::string& path);

/// The file of this name in PATH that may be executed; empty when there is none.
std::string find_in_path(const std::string& name);

/// The running program, with its path; empty when unknown.
std::string own_program();

/// Directory of the running program; empty when unknown.
std::string own_directory();

}  // namespace softgrain
