// Which files of a run directory hold results, and of which kind.
#pragma once

#include <filesystem>
#include <string>

#include "pipelines/results/kind_results.h"

namespace softgrain {

/// What a file of this name is among the results of any kind; null: none.
const ResultFile* result_file(const std::string& name);
/// The same of an HDF5 file by what is in it, whatever its name.
const ResultFile* result_file_of(const h5::Group& root);
/// By its name and, where that may be anybody's, by what it says of itself.
bool is_result_file(const std::filesystem::path& path);

}  // namespace softgrain
