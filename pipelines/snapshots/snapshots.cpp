#include "pipelines/snapshots/snapshots.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "common/core/error.h"
#include "common/data/snapshot_io.h"
#include "common/io/text_file.h"
#include "pipelines/results/kind_results.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;
using Visit = VisitSnapshot;

bool is_states_file(const std::string& name) { return name.starts_with("states") && name.ends_with(".h5"); }

/// A result file of a kind that keeps states in a form of its own; null: no such file.
const ResultFile* kind_file(const std::string& name) {
  const ResultFile* file = result_file(name);
  return file == nullptr || file->visit == nullptr ? nullptr : file;
}

/// The states of a file made by save_snapshots(); of a series only its last, when that is asked for.
void visit_states(const std::string& path, SnapshotChoice choice, const Visit& visit) {
  const h5::Group states = open_snapshots(path).open("states");
  const std::vector<std::string> names = states.children();
  std::map<std::string, std::string> last;
  for (const std::string& name : names) last[states.open(name).text("series")] = name;
  for (const std::string& name : names) {
    const h5::Group one = states.open(name);
    if (choice == SnapshotChoice::all || last[one.text("series")] == name) visit(read_snapshot(one));
  }
}

void visit_file(const std::string& path, const std::string& prefix, SnapshotChoice choice, const Visit& visit) {
  const std::string name = fs::path(path).filename().string();
  bool reading = true;  // trouble of the visitor is its own
  const Visit renamed = [&](const Snapshot& s) {
    Snapshot named = s;
    if (!prefix.empty()) {
      named.series = prefix + "/" + s.series;
      named.label = prefix + ": " + s.label;
    }
    reading = false;
    visit(named);
    reading = true;
  };
  try {
    if (is_states_file(name)) return visit_states(path, choice, renamed);
    if (const ResultFile* file = kind_file(name)) return file->visit(path, choice, renamed);
  } catch (const IoError& e) {
    const std::string text = e.what();
    if (!reading) throw;
    throw IoError(text.find(path) != std::string::npos ? text : path + ": damaged: " + text);
  }
  throw InputError(path +
                   ": holds no states: give a run directory, or its run.h5, states_*.h5, powder.h5 or grain_box.h5");
}

std::vector<std::string> files_of(const fs::path& directory) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(directory)) {
    const std::string name = entry.path().filename().string();
    if (holds_states(name)) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Directories that the summary of a run names as those of its variants or of its runs; empty without a summary.
std::optional<std::set<std::string>> named_parts(const fs::path& directory) {
  const std::string path = (directory / "summary.json").string();
  if (!fs::exists(path)) return std::nullopt;
  const nlohmann::json summary = nlohmann::json::parse(read_text(path), nullptr, false);
  std::set<std::string> names;
  if (!summary.is_object()) return names;
  for (const auto& [list, key] : {std::pair{"variants", "name"}, {"runs", "directory"}})
    if (const auto parts = summary.find(list); parts != summary.end() && parts->is_array())
      for (const nlohmann::json& part : *parts)
        if (part.is_object() && part.contains(key) && part[key].is_string()) names.insert(part[key].get<std::string>());
  return names;
}

/// Variants lie in directories of their own. Directories that an earlier run left there are none of this run: it names
/// its own in the summary, and a run that has no variants says with a file of its own (.run) of what it is.
std::vector<std::string> variants_of(const fs::path& directory) {
  std::vector<std::string> files;
  const auto named = named_parts(directory);
  if (!named && fs::exists(directory / ".run")) return files;
  for (const auto& entry : fs::directory_iterator(directory))
    if (entry.is_directory() && fs::exists(entry.path() / "summary.json") &&
        (!named || named->contains(entry.path().filename().string())))
      for (const std::string& file : files_of(entry.path())) files.push_back(file);
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

bool holds_states(const std::string& file_name) { return is_states_file(file_name) || kind_file(file_name) != nullptr; }

std::vector<std::string> snapshot_files(const std::string& run) {
  if (!fs::exists(run)) throw IoError(run + ": no such run directory or file");
  if (!fs::is_directory(run)) return {run};
  std::vector<std::string> files = files_of(run);
  for (const std::string& v : variants_of(run)) files.push_back(v);
  return files;
}

void for_each_snapshot(const std::string& run, SnapshotChoice choice, const Visit& visit) {
  for (const std::string& file : snapshot_files(run)) {
    const fs::path parent = fs::path(file).parent_path();
    const bool variant = fs::is_directory(run) && !fs::equivalent(parent, run);
    visit_file(file, variant ? parent.filename().string() : "", choice, visit);
  }
}

std::vector<Snapshot> read_snapshots(const std::string& run, SnapshotChoice choice) {
  std::vector<Snapshot> out;
  for_each_snapshot(run, choice, [&](const Snapshot& s) { out.push_back(s); });
  return out;
}

}  // namespace softgrain
