// Where softgrain-lammps is, and the words that start it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace softgrain::lammps {

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

}  // namespace softgrain::lammps
