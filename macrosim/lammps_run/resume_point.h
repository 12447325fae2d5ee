// Where a test in LAMMPS goes on.
#pragma once

#include <string>
#include <vector>

#include "macrosim/macro_spec.h"

namespace softgrain::lammps {

struct ResumePoint {
  bool done = false;                  ///< everything is recorded and the last state is there
  std::vector<std::string> settings;  ///< "-var", NAME, VALUE...
};

/// Finds where a test goes on, from the tables and restart files in the directory of a sample. Brings points.txt to the
/// point that the run goes on after. `stages`: for a test in stages, so that the script is told at which stresses they
/// began. `more`: as for read_points(). Throws what read_points() throws.
ResumePoint find_resume_point(const std::string& directory, const std::string& key, std::int64_t points,
                              const std::vector<MacroStage>& stages = {}, const std::vector<std::string>& more = {});

/// How far a compaction in LAMMPS is, 0 to 1, from its table; it moves with every pressure.
double compaction_share(const std::string& directory);

}  // namespace softgrain::lammps
