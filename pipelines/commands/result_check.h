// softgrain check of results: files of ours, summaries, run directories.
#pragma once

#include <string>

#include "pipelines/run/findings.h"

namespace softgrain {

/// An HDF5 file of any kind of ours: read as the commands would read it. Throws IoError when it is damaged.
void check_data(const std::string& path, Findings& out);

/// summary.json of a run: status, command, remarks. Throws InputError when it is none.
void check_summary(const std::string& path, Findings& out);

/// A run directory: its summary and every file of ours in it. Throws IoError when one of them is damaged, InputError
/// when there is none.
void check_directory(const std::string& path, Findings& out);

}  // namespace softgrain
