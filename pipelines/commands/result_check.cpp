#include "pipelines/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/data/snapshot_io.h"
#include "common/io/hdf5_file.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"
#include "pipelines/report/run_data.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/results/summary.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

namespace {

using nlohmann::json;
namespace fs = std::filesystem;

void check_states_file(const std::string& path, Findings& out) {
  const h5::Group states = open_snapshots(path).open("states");
  std::size_t contacts = 0;
  for (const std::string& name : states.children()) {
    try {
      contacts += read_snapshot(states.open(name)).contacts.size();
    } catch (const IoError& e) {
      throw IoError(path + ": state " + name + ": " + e.what());
    }
  }
  out.add("kind", "states",
          fmt::format("kept states: {}, with {} contacts in all", states.children().size(), contacts));
}

void check_other(const h5::Group& root, Findings& out) {
  const std::string names = join_text(root.children());
  const std::string format = root.has_attribute("format") ? root.text("format") + ", " : "";
  out.add("kind", format.empty() ? "HDF5" : root.text("format"), "readable HDF5 file: " + format + "with " + names);
}

/// Facts of one file of a directory under its name; its lines and warnings say which file they are of.
void check_one(const std::string& directory, const std::string& name,
               const std::function<void(const std::string&, Findings&)>& check, Findings& out) {
  Findings one;
  check(directory + "/" + name, one);
  out.facts["files"][name] = one.facts;
  out.lines += "  " + name + ":\n" + one.lines;
  for (const std::string& warning : one.warnings()) out.warn(name + ": " + warning);
}

/// A file with the name of one kind of results and the content of another is not what its name says.
void require_own_content(const std::string& path) {
  const ResultFile* named = result_file(fs::path(path).filename().string());
  const ResultFile* held = result_file_of(h5::open_file(path));
  if (named != nullptr && named->is != nullptr && held != nullptr && held != named)
    throw IoError(path + ": does not hold what files of this name hold: another file was put in its place");
}

/// Files of results that the summary of the run names and that are gone.
void warn_of_missing_files(const std::string& directory, Findings& out) {
  const json summary = json::parse(read_text(directory + "/summary.json"), nullptr, false);
  const auto files = summary.is_object() ? summary.find("files") : summary.end();
  if (files == summary.end() || !files->is_object()) return;
  std::error_code ignored;
  for (const json& file : *files) {
    if (!file.is_string()) continue;
    const std::string name = fs::path(file.get<std::string>()).filename().string();
    if (file_form(name) == FileForm::hdf5 && !fs::exists(directory + "/" + name, ignored))
      out.warn("the run wrote " + name + ", which is not here any more");
  }
}

/// A folder of scenes may have one with the name of a result, as pipelines/law_table.toml.
bool is_scene(const std::string& path) {
  if (file_form(path) != FileForm::toml) return false;
  try {
    return Scene::load(path).root().has("kind");
  } catch (const InputError&) {
    return false;
  }
}

/// Files that only a run at work needs are not looked at.
bool is_scratch(const std::string& name) {
  return name.starts_with("checkpoint") || name.ends_with(".tmp") || name.find(".previous") != std::string::npos;
}

}  // namespace

void check_data(const std::string& path, Findings& out) {
  const h5::Group root = h5::open_file(path);
  if (const ResultFile* file = result_file_of(root))
    file->check(path, out);
  else if (root.has("states"))
    check_states_file(path, out);
  else
    check_other(root, out);
  std::error_code failed;
  const auto bytes = fs::file_size(path, failed);
  if (!failed) out.facts["bytes"] = bytes;
}

void check_summary(const std::string& path, Findings& out) {
  const json summary = json::parse(read_text(path), nullptr, false);
  if (summary.is_discarded()) throw InputError(path + ": no JSON");
  const auto known = record_of<AnySummary>(summary);
  if (known.status.empty()) throw InputError(path + ": no summary of a run: it has no \"status\"");
  out.add("kind", "summary",
          fmt::format("summary of softgrain {} ({} {}): {}", known.command, known.version, known.commit, known.status));
  out.facts["run_status"] = known.status;
  out.facts["command"] = known.command;
  if (!is_good(known.status)) out.warn("the run says of itself: " + known.status);
  for (const std::string& warning : warnings_of(known)) out.warn(warning);
  out.facts["notes"] = notes_of(known);
  for (const std::string& note : notes_of(known)) out.lines += "  note: " + note + "\n";
}

namespace {

/// How a file of a run directory is looked at; null: it is not.
void (*check_of(const std::string& name))(const std::string&, Findings&) {
  if (is_scratch(name)) return nullptr;
  if (name == "summary.json") return check_summary;
  if (file_form(name) == FileForm::hdf5) return check_data;
  const ResultFile* file = result_file(name);
  return file == nullptr ? nullptr : file->check;
}

}  // namespace

void check_directory(const std::string& path, Findings& out) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(path)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  out.add("kind", "run directory", "run directory");
  bool any = false;
  const auto has = [&](const std::string& name) { return std::binary_search(names.begin(), names.end(), name); };
  for (const std::string& name : names)
    if (const auto check = check_of(name); check != nullptr && !is_scene(path + "/" + name)) {
      any = true;
      if (check == check_data) require_own_content(path + "/" + name);
      check_one(path, name, check, out);
    }
  if (!any) throw InputError(report::why_without_results(path));
  if (!has("summary.json"))
    out.warn("no summary.json: the run has not ended; go on with --resume, or see log.txt for what stopped it");
  else
    warn_of_missing_files(path, out);
  if (has("checkpoint.h5")) out.warn("a checkpoint is there: the run was stopped, --resume goes on with it");
}

}  // namespace softgrain
