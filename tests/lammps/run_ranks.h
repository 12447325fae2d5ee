// softgrain-lammps under MPI, as a child of a test.
#pragma once

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

namespace softgrain::test {

inline std::string read_text(const std::string& path) {
  std::ostringstream out;
  out << std::ifstream(path).rdbuf();
  return out.str();
}

/// Runs a script in a directory; what was said goes to screen.txt there. Returns what std::system does. The test is an
/// MPI process itself, whose environment would lead mpirun astray.
inline int run_ranks(int ranks, const std::string& directory, const std::string& arguments) {
  const std::string command =
      "for v in $(env | grep -E '^(PMIX|OMPI|OPAL|ORTE|PRTE)_' | cut -d= -f1); do unset $v; done; cd '" + directory +
      "' && OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_mpi_yield_when_idle=1 OMP_NUM_THREADS=1 "
      "mpirun --oversubscribe --bind-to none -np " +
      std::to_string(ranks) + " '" SOFTGRAIN_LAMMPS_PROGRAM "' " + arguments + " -log none > screen.txt 2>&1";
  return std::system(command.c_str());
}

}  // namespace softgrain::test
