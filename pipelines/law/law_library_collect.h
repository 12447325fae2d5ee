// A library from the law tables below directories.
#pragma once

#include <string>
#include <vector>

#include "pipelines/law/law_library.h"

namespace softgrain {

/// A table, or an entry of one, that is not in a library.
struct LeftOutTable {
  std::string path;
  std::string why;
  bool damaged = false;  ///< it cannot be read, or has another shell or other neighbours; else its law does not serve
};

struct LibraryCollection {
  LawLibrary library;
  std::vector<LeftOutTable> left_out;
};

/// The entries of all law_table.toml below directories at any depth, in the order of their names, as rows of a library
/// with its checks. Shell and neighbours are those that most entries have. Tables that do not go with these, or cannot
/// be read, are left out. Throws InputError where a directory has no table, or too few entries are left.
LibraryCollection collect_library(const std::vector<std::string>& directories);

/// "left out: PATH: why", a line each.
std::string left_out_text(const std::vector<LeftOutTable>& left_out);

}  // namespace softgrain
