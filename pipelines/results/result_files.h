// Which files of a run directory hold results, and of which kind.
#pragma once

#include <filesystem>
#include <string>

#include "pipelines/results/kind_results.h"

namespace softgrain {

/// What a file of this name is among the results of any kind; null: none.
const ResultFile* result_file(const std::string& name);
/// What an HDF5 file is among the results of any kind, by its content, whatever its name; null: none.
const ResultFile* result_file_of(const h5::Group& root);
/// Whether a file is a result of this program, by its name and, where other programs may use that name, by its content.
bool is_result_file(const std::filesystem::path& path);

}  // namespace softgrain
