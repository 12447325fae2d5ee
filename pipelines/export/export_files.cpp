#include "pipelines/export/export_files.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "common/core/error.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;

std::string extension_of(ExportFormat format) {
  switch (format) {
    case ExportFormat::vtp:
      return "vtp";
    case ExportFormat::lammps_dump:
      return "dump";
    case ExportFormat::lammps_data:
      return "data";
    case ExportFormat::csv:
      return "csv";
  }
  return "";
}

std::string quoted_for_regex(const std::string& text) {
  static const std::regex special(R"([.^$|()\[\]{}*+?\\])");
  return std::regex_replace(text, special, R"(\$&)");
}

/// States, and the indices of series; `stem`: a regular expression of the name of the series.
std::regex names_of(ExportFormat format, const std::string& stem) {
  std::string index;
  if (format == ExportFormat::vtp) index = "|" + stem + "_(particles|contacts)\\.pvd";
  if (format == ExportFormat::csv) index = "|" + stem + "\\.csv";
  return std::regex(stem + "_(particles|contacts|wall_contacts|walls)_[0-9]{6,}\\." + extension_of(format) + index);
}

/// Regular files of a directory; empty when there is none.
std::vector<std::string> names_in(const std::string& directory) {
  std::vector<std::string> out;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(directory, error))
    if (entry.is_regular_file(error)) out.push_back(entry.path().filename().string());
  return out;
}

}  // namespace

ExportList::ExportList(const std::string& directory, ExportFormat format) : directory_(directory), format_(format) {}

bool ExportList::exists() const {
  std::error_code error;
  return fs::exists(directory_ + "/.export-" + to_string(format_), error);
}

bool ExportList::is_default_folder() const {
  const fs::path path(directory_);
  return (path.has_filename() ? path : path.parent_path()).filename() == export_folder(format_);
}

bool ExportList::holds(const std::string& name) const {
  std::error_code error;
  return fs::exists(fs::symlink_status(directory_ + "/" + name, error));
}

void ExportList::remove(const std::string& name) const {
  const std::string path = directory_ + "/" + name;
  std::error_code error;
  fs::remove(path, error);
  if (error) throw IoError(path + ": of an earlier export, cannot be removed: " + error.message());
}

void ExportList::remove_listed() const {
  if (!exists()) return;
  const std::string list = ".export-" + to_string(format_);
  std::istringstream lines(read_text(directory_ + "/" + list));
  const std::regex names = names_of(format_, ".+");
  std::vector<std::string> listed;
  for (std::string name; std::getline(lines, name);)
    if (std::regex_match(name, names) && name.find('/') == std::string::npos) listed.push_back(name);
  // Indices were written last: they go first, so that none ever names states that are gone.
  for (auto name = listed.rbegin(); name != listed.rend(); ++name) remove(*name);
  remove(list);
}

void ExportList::remove_series(const std::string& series) const {
  const std::regex names = names_of(format_, quoted_for_regex(file_name_of(series)));
  for (const std::string& name : names_in(directory_))
    if (std::regex_match(name, names)) remove(name);
}

void ExportList::remove_named() const {
  const std::regex names = names_of(format_, ".+");
  for (const std::string& name : names_in(directory_))
    if (std::regex_match(name, names)) remove(name);
}

void ExportList::add(const std::string& name) const {
  const std::string path = directory_ + "/.export-" + to_string(format_);
  std::ofstream list(path, std::ios::app);
  list << name << '\n';
  list.flush();
  if (!list) throw IoError(path + ": cannot be written");
}

std::string export_folder(ExportFormat format) { return "export-" + to_string(format); }

void remove_exports_of(const std::string& run_directory) {
  for (const auto& [format, name] : enum_names<ExportFormat>) {
    const std::string directory = run_directory + "/" + export_folder(format);
    std::error_code error;
    if (!fs::is_directory(directory, error)) continue;
    const ExportList list(directory, format);
    if (list.exists())
      list.remove_listed();
    else
      list.remove_named();  // of an earlier version, in a directory that it named
    if (fs::is_empty(directory, error)) fs::remove(directory, error);
  }
}

}  // namespace softgrain
