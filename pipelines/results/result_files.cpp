#include "pipelines/results/kind_results.h"

#include <regex>

#include "common/core/error.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;

struct NamedFile {
  std::regex names;
  ResultFile file;
};

const std::vector<NamedFile>& result_files() {
  static const std::vector<NamedFile> files = [] {
    std::vector<NamedFile> all;
    for (const KindResults& kind : results_of_kinds())
      for (const ResultFile& file : kind.files) all.push_back({std::regex(file.names), file});
    return all;
  }();
  return files;
}

bool wrote(const fs::path& path) {
  try {
    const h5::Group root = h5::open_file(path);
    return root.has("provenance") && root.open("provenance").text("program") == "softgrain";
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

const ResultFile* result_file(const std::string& name) {
  for (const NamedFile& known : result_files())
    if (std::regex_match(name, known.names)) return &known.file;
  return nullptr;
}

const ResultFile* result_file_of(const h5::Group& root) {
  for (const NamedFile& known : result_files())
    if (known.file.is != nullptr && known.file.is(root)) return &known.file;
  return nullptr;
}

bool is_result_file(const fs::path& path) {
  const ResultFile* file = result_file(path.filename().string());
  return file != nullptr && (!file->says_so || wrote(path));
}

}  // namespace softgrain
