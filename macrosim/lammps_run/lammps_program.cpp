#include "macrosim/lammps_run/lammps_program.h"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "common/core/error.h"
#include "common/io/child_process.h"
#include "macrosim/lammps_run/input_script.h"

namespace softgrain::lammps {

std::string find_program() {
  const char* named = std::getenv("SOFTGRAIN_LAMMPS");
  if (named != nullptr && *named != '\0') {
    if (!is_program(named)) throw InputError("SOFTGRAIN_LAMMPS=" + std::string(named) + ": no program there");
    return std::filesystem::absolute(named).string();
  }
  const std::string beside = own_directory() + "/" + kProgramName;
  if (is_program(beside)) return beside;
  const std::string found = find_in_path(kProgramName);
  return found.empty() ? "" : std::filesystem::absolute(found).string();
}

std::string missing_text() {
  return std::string(kProgramName) +
         " is not there, which runs the scene: ./softgrain setup --with-lammps builds it (or name it by the "
         "environment "
         "variable SOFTGRAIN_LAMMPS; --write-only only writes the files)";
}

std::vector<std::string> command_words(const std::string& program, std::int64_t ranks,
                                       const std::vector<std::string>& settings) {
  std::vector<std::string> words;
  if (ranks > 1) {
    const std::string mpirun = find_in_path("mpirun");
    if (mpirun.empty())
      throw InputError("--ranks: no mpirun in PATH to start several ranks with (./softgrain setup --with-lammps)");
    // Ranks that wait give way to others: on a machine that does something else too, spinning ones stop it all.
    words = {mpirun, "--oversubscribe",    "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1",
             "-np",  std::to_string(ranks)};
    if (::geteuid() == 0) words.insert(words.begin() + 1, "--allow-run-as-root");
  }
  words.insert(words.end(), {program, "-in", kScriptFile, "-log", "none"});
  words.insert(words.end(), settings.begin(), settings.end());
  return words;
}

}  // namespace softgrain::lammps
