// Where softgrain-lammps is, and how it is started: as a process of its own, without a shell between.
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

/// The file of this name in PATH that may be executed; empty when there is none.
std::string find_in_path(const std::string& name);

/// The running program, with its path; empty when unknown.
std::string own_program();

/// Directory of the running program; empty when unknown.
std::string own_directory();

namespace lammps {

inline constexpr const char* kProgramName = "softgrain-lammps";

/// The program named by SOFTGRAIN_LAMMPS, else the one beside our own, else the first in PATH; empty when there is
/// none. Throws InputError when SOFTGRAIN_LAMMPS names none.
std::string find_program();

/// What to do without it.
std::string missing_text();

/// The command that runs the script in its directory; one rank goes without mpirun. `settings`: -var NAME VALUE.
/// Throws InputError when there is no mpirun for several ranks.
std::vector<std::string> command_words(const std::string& program, std::int64_t ranks,
                                       const std::vector<std::string>& settings);

}  // namespace lammps

}  // namespace softgrain
