#include "pipelines/report/run_data.h"

#include <algorithm>
#include <filesystem>

#include "common/core/error.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"
#include "pipelines/results/kind_results.h"
#include "pipelines/results/summary.h"

namespace softgrain::report {
namespace {

namespace fs = std::filesystem;

nlohmann::json parse_summary(const std::string& path) {
  auto summary = nlohmann::json::parse(read_text(path), nullptr, false);
  if (summary.is_discarded() || !summary.is_object()) throw IoError(path + ": is not a JSON object");
  return summary;
}

/// A scene of comparison.json and the file of its curves.
struct NamedCurves {
  std::string name;
  std::string file;
};
void fields(auto&& visit, Of<NamedCurves> auto& s) {
  visit("name", s.name);
  visit("file", s.file);
}

/// The scenes that a comparison names; a file that is not there is trouble, as the comparison says it is.
std::vector<ComparedCurves> load_scenes(const std::string& directory) {
  const nlohmann::json root = parse_summary(directory + "/comparison.json");
  std::vector<NamedCurves> named;
  if (!root.contains("scenes") || !read_json(root["scenes"], named))
    throw IoError(directory + "/comparison.json: has no scenes");
  std::vector<ComparedCurves> scenes;
  for (const NamedCurves& one : named)
    scenes.push_back({one.name, load_macro(directory + "/" + fs::path(one.file).filename().string())});
  return scenes;
}

}  // namespace

std::string RunData::kind() const {
  const auto known = summary_as<AnySummary>();
  if (!known.kind.empty() || !known.provenance || known.provenance->scene.empty()) return known.kind;
  try {
    const auto keys = flat_scene(known.provenance->scene, "scene");
    const auto at = keys.find("kind");
    return at == keys.end() ? "" : at->second;
  } catch (const InputError&) {
    return "";
  }
}

const PairLaw* RunData::law(PairKind kind) const {
  const PairLaw* found = card ? card->find(kind) : nullptr;
  return found != nullptr && found->normal.a.value > 0.0 ? found : nullptr;
}

std::string RunData::relaxation(PairKind kind) const {
  if (!measurements) return "";
  const auto present = relaxations_of(*measurements, kind);
  for (const std::string& name : present) {
    if (card && name == card->relaxation) return name;
  }
  return present.empty() ? "" : present.front();
}

StiffnessAngles RunData::angles(PairKind kind) const {
  const PairLaw* found = card ? card->find(kind) : nullptr;
  if (found == nullptr) return {};
  return {found->initial_angle_deg, found->secant_angle_deg};
}

bool is_unfinished(const std::string& directory) {
  const auto exists = [&](const char* name) { return fs::exists(directory + "/" + name); };
  return !exists("summary.json") && (exists(".run") || exists(".runs") || exists("work") || exists("checkpoint.h5"));
}

std::string why_without_results(const std::string& directory) {
  return directory + (is_unfinished(directory)
                          ? ": this run has not come to its end and has no results yet: --resume goes on with it"
                          : ": no run directory: neither summary.json nor a file of results is in it");
}

RunData load_run(const std::string& directory) {
  if (!fs::is_directory(directory)) throw IoError(directory + ": no such run directory");
  RunData run;
  run.unfinished = is_unfinished(directory);
  run.directory = directory;
  run.summary = nlohmann::json::object();
  const auto file = [&](const char* name) { return directory + "/" + name; };
  const auto exists = [&](const char* name) { return fs::exists(file(name)); };
  bool any = false;
  if (exists("summary.json")) run.summary = parse_summary(file("summary.json")), any = true;
  if (exists("measurements.h5")) run.measurements = load_measurements(file("measurements.h5")), any = true;
  if (exists("law.toml")) run.card = load_card(file("law.toml")), any = true;
  for (const char* name : {kMultiContactFile, kEarlierMultiContactFile})
    if (!run.multi_contact && exists(name)) run.multi_contact = load_multi_contact(file(name)), any = true;
  if (exists("law_table.toml")) run.law_table = load_law_table(file("law_table.toml")), any = true;
  if (exists("macro.h5")) run.macro = load_macro(file("macro.h5")), any = true;
  if (exists("comparison.json")) run.macro_scenes = load_scenes(directory), any = true;
  any = any || std::any_of(fs::directory_iterator(directory), fs::directory_iterator(),
                           [](const fs::directory_entry& entry) { return is_result_file(entry.path()); });
  if (!any) throw IoError(why_without_results(directory));
  return run;
}

}  // namespace softgrain::report
