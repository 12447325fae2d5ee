// The report of a run: one self-contained page with figures and tables, readable without a network and printable.
#pragma once

#include <string>

namespace softgrain {

/// Reads what DIR holds (summary.json, measurements.h5, law.toml, law.h5, macro.h5, grain_box.h5) and writes
/// DIR/report.html. Sections without data are left out. Throws IoError for missing, damaged or unwritable files.
void write_report(const std::string& run_directory);

}  // namespace softgrain
