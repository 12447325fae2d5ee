// softgrain check of tables that people bring: measurements of an experiment, sieve curves, radii.
#pragma once

#include <string>

#include "pipelines/run/findings.h"

namespace softgrain {

/// Says which data a text of columns holds, how many, and what takes them. Throws InputError where it holds none of
/// these or they are not sound, IoError.
void check_table(const std::string& path, Findings& out);

}  // namespace softgrain
