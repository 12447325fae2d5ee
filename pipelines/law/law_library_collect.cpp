#include "pipelines/law/law_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "common/core/error.h"
#include "common/core/text.h"
#include "pipelines/law/fitted_law.h"
#include "pipelines/law/law_library_predict.h"
#include "pipelines/law/law_library_press.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;

/// An entry that was read.
struct FoundEntry {
  std::string path;
  std::string source;  ///< name of the directory and place below it
  LawTableEntry entry;
};

/// The law tables below a directory, in the order of their names.
std::vector<std::string> law_tables_below(const std::string& directory) {
  std::error_code error;
  if (!fs::is_directory(directory, error)) throw InputError("law library: " + directory + " is no directory");
  std::vector<std::string> out;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(directory))
    if (entry.path().filename() == "law_table.toml") out.push_back(entry.path().string());
  if (out.empty()) throw InputError("law library: no law_table.toml below " + directory);
  std::ranges::sort(out);
  return out;
}

/// The entries of a table with their refits. Throws InputError, IoError for what is no table.
std::vector<LawTableEntry> entries_of(const std::string& path) {
  FittedLaw law = load_law(path);
  if (law.table() == nullptr) throw InputError(path + ": is no law table");
  read_refits(law);
  return law.table()->entries;
}

std::vector<FoundEntry> found_entries(const std::vector<std::string>& directories,
                                      std::vector<LeftOutTable>& left_out) {
  std::vector<FoundEntry> out;
  for (const std::string& directory : directories) {
    const fs::path top = fs::path(directory) / "";  // of "A" and of "A/" the same name
    for (const std::string& path : law_tables_below(directory)) {
      const fs::path below = fs::path(path).parent_path().lexically_relative(directory);
      const std::string source = (top.parent_path().filename() / below).lexically_normal().string();
      try {
        for (LawTableEntry& entry : entries_of(path)) out.push_back({path, source, std::move(entry)});
      } catch (const InputError& e) {
        left_out.push_back({path, e.what(), true});
      } catch (const IoError& e) {
        left_out.push_back({path, e.what(), true});
      }
    }
  }
  return out;
}

/// An empty library with the shell and the neighbours that most entries have, the first of those that are as many.
LawLibrary most_common(const std::vector<FoundEntry>& found) {
  std::vector<std::pair<LawLibrary, int>> kinds;
  for (const FoundEntry& f : found) {
    if (f.entry.find(LawForm::isotropic) == nullptr || f.entry.spec.sizes || f.entry.source != TableSource::measured)
      continue;
    const LawLibrary its = library_like(f.entry);
    const auto same = [&](const auto& kind) {
      return kind.first.partners == its.partners && kind.first.rmax_over_shell == its.rmax_over_shell &&
             kind.first.beta == its.beta;
    };
    const auto known = std::ranges::find_if(kinds, same);
    if (known == kinds.end())
      kinds.emplace_back(its, 1);
    else
      ++known->second;
  }
  const auto most = std::ranges::max_element(kinds, {}, [](const auto& kind) { return kind.second; });
  return most == kinds.end() ? LawLibrary{} : most->first;
}

/// To the digits that a file of a library has.
bool is_same_material(const LibraryPoint& a, const LibraryPoint& b) {
  constexpr double kDigits = 1e-6;
  return std::ranges::all_of(kLibraryVariables, [&](const LibraryVariable& v) {
    return std::abs(a.*v.value - b.*v.value) <= kDigits * std::abs(b.*v.value);
  });
}

}  // namespace

LibraryCollection collect_library(const std::vector<std::string>& directories, const LawLibrary& known) {
  LibraryCollection out;
  const std::vector<FoundEntry> found = found_entries(directories, out.left_out);
  if (known.materials.empty()) {
    out.library = most_common(found);
  } else {
    out.library = known;
    out.library.path.clear();  // it is another one
    out.library.text.clear();
  }
  for (const FoundEntry& f : found) {
    std::string why;
    try {
      auto row = library_row(out.library, f.entry, f.source, why);
      const auto same = [&](const LibraryMaterial& m) { return row && is_same_material(m.at, row->at); };
      if (std::ranges::any_of(known.materials, same))
        out.left_out.push_back({f.path, "the library has it already"});
      else if (row)
        out.library.materials.push_back(std::move(*row));
      else
        out.left_out.push_back({f.path, why});
    } catch (const InputError& e) {
      out.left_out.push_back({f.path, e.what(), true});
    }
  }
  if (out.library.materials.size() < least_materials())
    throw InputError(fmt::format("law library: {}; it needs at least {}\n{}",
                                 counted(out.library.materials.size(), "material"), least_materials(),
                                 left_out_text(out.left_out)));
  out.library.checks = check_library(out.library);
  out.library.press_checks = check_press_tests(out.library);
  return out;
}

std::string left_out_text(const std::vector<LeftOutTable>& left_out) {
  std::string text;
  for (const LeftOutTable& t : left_out) text += fmt::format("left out: {}: {}\n", t.path, t.why);
  return text;
}

}  // namespace softgrain
