// Which files of a directory an export left there, so that a new export or run takes them away and nothing else.
#pragma once

#include <string>
#include <vector>

#include "pipelines/export/export.h"

namespace softgrain {

/// The list of what one form of export wrote into a directory: a hidden file there, a name a line.
class ExportList {
 public:
  ExportList(const std::string& directory, ExportFormat format);

  /// Removes the files that an earlier export of this form listed, and the list. Throws IoError.
  void remove_listed() const;
  /// Removes the files of one series by the names that this form gives them, whether listed or not: what an earlier
  /// version, which kept no list, left in a directory that it named.
  void remove_series(const std::string& series) const;
  /// Removes every file with a name that this form gives.
  void remove_named() const;
  /// Lists a file before it is written, so that an export that breaks off has listed it. Throws IoError.
  void add(const std::string& name) const;
  /// Whether an export of this form kept a list here.
  [[nodiscard]] bool exists() const;
  /// Whether the directory has the name that exports of this form get by default.
  [[nodiscard]] bool is_default_folder() const;
  /// Whether something of this name is in the directory.
  [[nodiscard]] bool holds(const std::string& name) const;

 private:
  void remove(const std::string& name) const;

  std::string directory_;
  ExportFormat format_;
};

/// Default directory of an export, beside the states: export-vtp, export-lammps-dump, export-lammps-data, export-csv.
std::string export_folder(ExportFormat format);

/// What exports left in the default directories of a run; a directory goes when nothing else is in it.
void remove_exports_of(const std::string& run_directory);

}  // namespace softgrain
