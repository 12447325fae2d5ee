// Two run directories, compared bit by bit but for the circumstances of the runs.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "common/io/text_file.h"
#include "tests/support/hdf5_contents.h"

namespace softgrain::test {

/// Files that are not compared: the log has times, the report draws what the other files hold and says when and how
/// long, the lock stays behind, what the run is of holds its scene.
inline const std::set<std::string> kFilesOfCircumstance{"log.txt", "report.html", ".lock", ".run"};

/// Names of data sets, attributes, keys and columns that say how a run went and not what came out: anything with one of
/// these words. "provenance" and "files" are whole tables or groups. Numbers of loop passes and contact evaluations are
/// results: they must agree. "belongs_to" is a hash over a law file with its provenance.
inline const std::vector<std::string> kCircumstances{"provenance", "seconds", "memory", "files",     "command",
                                                     "cpu",        "faster",  "commit", "belongs_to"};

/// Parts of the stepping loop that only the last of several processes has gone through.
inline const std::set<std::string> kPartsOfLoop{"warm_up", "measured"};

inline bool is_circumstance(const std::string& name) {
  return kPartsOfLoop.contains(name) ||
         std::any_of(kCircumstances.begin(), kCircumstances.end(),
                     [&](const std::string& word) { return name.find(word) != std::string::npos; });
}

namespace comparison {

namespace fs = std::filesystem;
using nlohmann::json;

inline void strip(json& value) {
  if (value.is_object())
    for (auto it = value.begin(); it != value.end();)
      it = is_circumstance(it.key()) ? value.erase(it) : (strip(*it), std::next(it));
  if (value.is_array())
    for (json& child : value) strip(child);
}

/// The lines of a TOML file but for comments (they say what wrote it) and tables of circumstance.
inline std::string toml_results(const std::string& text) {
  std::istringstream lines(text);
  std::string out;
  bool skipped = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("[")) skipped = is_circumstance(line);
    const std::string key = line.substr(0, line.find('='));
    if (!skipped && !line.starts_with("#") && !(line.find('=') != std::string::npos && is_circumstance(key)))
      out += line + "\n";
  }
  return out;
}

inline std::vector<std::string> cells_of(const std::string& line, char separator) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, separator);) cells.push_back(cell);
  return cells;
}

/// A table of CSV or Markdown without columns of circumstance (those headed by "s", a time, among them).
inline std::string table_results(const std::string& text, char separator) {
  std::istringstream lines(text);
  std::string out;
  std::vector<bool> kept;
  for (std::string line; std::getline(lines, line);) {
    const std::vector<std::string> cells = cells_of(line, separator);
    if (kept.empty())
      for (const std::string& cell : cells) kept.push_back(!is_circumstance(cell) && cell != " s " && cell != "s");
    for (std::size_t k = 0; k < cells.size(); ++k)
      if (k >= kept.size() || kept[k]) out += cells[k] + "|";
    out += "\n";
  }
  return out;
}

/// "/bodies/final@seconds" has a name of circumstance in it.
inline bool is_circumstance_path(const std::string& path) {
  std::string part;
  for (const char c : path + "/") {
    if (c != '/' && c != '@') {
      part += c;
      continue;
    }
    if (is_circumstance(part)) return true;
    part.clear();
  }
  return false;
}

inline std::vector<std::string> hdf5_differences(const fs::path& a, const fs::path& b) {
  Hdf5Contents x = hdf5_contents(a.string());
  Hdf5Contents y = hdf5_contents(b.string());
  for (Hdf5Contents* c : {&x, &y}) std::erase_if(*c, [](const auto& item) { return is_circumstance_path(item.first); });
  std::vector<std::string> out;
  for (const auto& [name, value] : x)
    if (!y.contains(name))
      out.push_back(name + ": only in the first");
    else if (y[name] != value)
      out.push_back(name + ": differs");
  for (const auto& [name, value] : y)
    if (!x.contains(name)) out.push_back(name + ": only in the second");
  return out;
}

/// What is compared of a file that is no HDF5.
inline std::string results_of(const fs::path& file) {
  const std::string text = read_text(file.string());
  const std::string kind = file.extension().string();
  if (kind == ".json") {
    json value = json::parse(text);
    strip(value);
    return value.dump(1);
  }
  if (kind == ".toml") return toml_results(text);
  if (kind == ".csv") return table_results(text, ',');
  if (kind == ".md") return table_results(text, '|');
  return text;
}

inline std::string first_difference(const std::string& a, const std::string& b) {
  const auto [p, q] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  const auto at = static_cast<std::size_t>(p - a.begin());
  const std::size_t from = at < 60 ? 0 : at - 60;
  return "\n  first:  ..." + a.substr(from, 120) + "\n  second: ..." + b.substr(from, 120);
}

inline std::set<std::string> files_below(const std::string& directory) {
  std::set<std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(directory))
    if (entry.is_regular_file() && !kFilesOfCircumstance.contains(entry.path().filename().string()))
      out.insert(fs::relative(entry.path(), directory).string());
  return out;
}

}  // namespace comparison

/// What differs between two run directories; empty when all results have the same bits. `left_out`: file names that are
/// not looked at either.
inline std::vector<std::string> run_differences(const std::string& a, const std::string& b,
                                                const std::set<std::string>& left_out = {}) {
  namespace fs = std::filesystem;
  std::set<std::string> files = comparison::files_below(a);
  files.merge(comparison::files_below(b));
  std::vector<std::string> out;
  for (const std::string& file : files) {
    if (left_out.contains(fs::path(file).filename().string())) continue;
    const fs::path x = fs::path(a) / file;
    const fs::path y = fs::path(b) / file;
    if (!fs::exists(x) || !fs::exists(y)) {
      out.push_back(file + ": only in " + (fs::exists(x) ? a : b));
    } else if (x.extension() == ".h5") {
      for (const std::string& d : comparison::hdf5_differences(x, y)) out.push_back(file + d);
    } else if (const std::string p = comparison::results_of(x), q = comparison::results_of(y); p != q) {
      out.push_back(file + ": " + comparison::first_difference(p, q));
    }
  }
  return out;
}

/// Fails the running test for every difference; and when there is nothing to compare.
inline void expect_same_runs(const std::string& a, const std::string& b, const std::set<std::string>& left_out = {}) {
  EXPECT_TRUE(std::filesystem::exists(a + "/summary.json")) << a << " has no summary";
  for (const std::string& d : run_differences(a, b, left_out)) ADD_FAILURE() << d << "\n  (" << a << ", " << b << ")";
}

}  // namespace softgrain::test
