
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "common/core/error.h"
#include "common/io/hdf5_file.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"
#include "pipelines/report/run_data.h"
#include "pipelines/report/sections.h"
#include "pipelines/runs/set_text.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;

using Keys = std::map<std::string, std::string>;

/// What of a run's summary says what it was made from.
struct MadeFrom {
  std::optional<Provenance> provenance;
  nlohmann::json law;
};

void fields(auto&& visit, Of<MadeFrom> auto& s) {
  visit("provenance", s.provenance);
  visit("law", s.law);
}

std::optional<Provenance> provenance_of_file(const std::string& path) {
  const std::lock_guard lock(h5::library_mutex());
  const h5::Group root = h5::open_file(path);
  if (!root.has("provenance")) return std::nullopt;
  const h5::Group group = root.open("provenance");
  Provenance p;
  p.scene = group.text("scene");
  p.seed = static_cast<std::uint64_t>(group.integer("seed"));
  return p;
}

MadeFrom made_from(const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    const std::string summary = path + "/summary.json";
    if (!fs::exists(summary, ignored)) return {};
    return record_of<MadeFrom>(nlohmann::json::parse(read_text(summary), nullptr, false));
  }
  if (file_form(path) == FileForm::hdf5) return {provenance_of_file(path), {}};
  return {};
}

/// Empty: not known.
Keys keys_of(const std::string& path) {
  try {
    const MadeFrom from = made_from(path);
    if (!from.provenance || from.provenance->scene.empty()) return {};
    Keys keys = flat_scene(from.provenance->scene, path);
    keys.erase("title");
    keys["seed"] = std::to_string(from.provenance->seed);
    if (const auto hash = from.law.find("hash"); from.law.is_object() && hash != from.law.end() && hash->is_string())
      keys["numbers of the law"] = hash->get<std::string>();
    return keys;
  } catch (const Error&) {  // what cannot be read is said where its numbers are read
    return {};
  }
}

}  // namespace

std::vector<SweptKey> scene_differences(const std::vector<std::string>& paths) {
  std::vector<Keys> runs;
  std::set<std::string> names;
  for (const std::string& path : paths) {
    runs.push_back(keys_of(path));
    for (const auto& [key, ignored] : runs.back()) names.insert(key);
  }
  std::vector<SweptKey> out;
  for (const std::string& name : names) {
    SweptKey one{name, {}};
    std::set<std::string> known;
    for (const Keys& keys : runs) {
      const auto at = keys.find(name);
      one.values.push_back(keys.empty() ? "?" : at == keys.end() ? "-" : at->second);
      if (!keys.empty()) known.insert(one.values.back());
    }
    if (known.size() > 1) out.push_back(std::move(one));
  }
  return out;
}

void read_numbers(const std::string& directory, RunEntry& entry) {
  const report::RunData run = report::load_run(directory);
  const auto summary = run.summary_as<AnySummary>();
  entry.status = parse_enum<RunStatus>(summary.status).value_or(RunStatus::good);
  if (summary.seconds) entry.seconds = *summary.seconds;
  if (const std::vector<std::string> why = warnings_of(summary); entry.status == RunStatus::not_usable && !why.empty())
    entry.reason = why.front();
  entry.numbers = report::values_of(run);
}

}  // namespace softgrain
