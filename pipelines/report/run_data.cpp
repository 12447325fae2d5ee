#include "pipelines/report/run_data.h"

#include <filesystem>

#include "common/core/error.h"
#include "common/io/text_file.h"

namespace softgrain::report {
namespace {

namespace fs = std::filesystem;

nlohmann::json parse_summary(const std::string& path) {
  auto summary = nlohmann::json::parse(read_text(path), nullptr, false);
  if (summary.is_discarded() || !summary.is_object()) throw FileTrouble(path + ": is not a JSON object");
  return summary;
}

/// The scenes that a comparison names; a file that is not there is trouble, as the comparison says it is.
std::vector<MacroScene> load_scenes(const std::string& directory) {
  const nlohmann::json root = parse_summary(directory + "/comparison.json");
  std::vector<MacroScene> scenes;
  const auto* list = find_value(root, "scenes");
  if (list == nullptr || !list->is_array()) throw FileTrouble(directory + "/comparison.json: has no scenes");
  for (const auto& one : *list) {
    const std::string name = find_text(one, "name");
    scenes.push_back({name, load_macro(directory + "/" + fs::path(find_text(one, "file")).filename().string())});
  }
  return scenes;
}

}  // namespace

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

RunData load_run(const std::string& directory) {
  if (!fs::is_directory(directory)) throw FileTrouble(directory + ": no such run directory");
  RunData run;
  run.directory = directory;
  run.summary = nlohmann::json::object();
  const auto file = [&](const char* name) { return directory + "/" + name; };
  const auto exists = [&](const char* name) { return fs::exists(file(name)); };
  bool any = false;
  if (exists("summary.json")) run.summary = parse_summary(file("summary.json")), any = true;
  if (exists("measurements.h5")) run.measurements = load_measurements(file("measurements.h5")), any = true;
  if (exists("law.toml")) run.card = load_card(file("law.toml")), any = true;
  if (exists("crowd.h5")) run.crowd = load_crowd(file("crowd.h5")), any = true;
  if (exists("law_table.toml")) run.law_table = load_law_table(file("law_table.toml")), any = true;
  if (exists("macro.h5")) run.macro = load_macro(file("macro.h5")), any = true;
  if (exists("comparison.json")) run.macro_scenes = load_scenes(directory), any = true;
  if (exists("grain_box.h5")) run.grain_boxes = load_grain_boxes(file("grain_box.h5")), any = true;
  if (exists("powder.h5")) run.powder = load_powder(file("powder.h5")), any = true;
  if (!any)
    throw FileTrouble(directory +
                      ": holds none of summary.json, measurements.h5, law.toml, macro.h5, grain_box.h5, powder.h5");
  return run;
}

const nlohmann::json* find_value(const nlohmann::json& root, const std::string& path) {
  const nlohmann::json* at = &root;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string key = path.substr(begin, end - begin);
    if (!at->is_object() || !at->contains(key)) return nullptr;
    at = &(*at)[key];
    begin = end + 1;
  }
  return at;
}

std::optional<double> find_number(const nlohmann::json& root, const std::string& path) {
  const nlohmann::json* found = find_value(root, path);
  if (found == nullptr || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

std::string find_text(const nlohmann::json& root, const std::string& path) {
  const nlohmann::json* found = find_value(root, path);
  if (found == nullptr || found->is_null()) return "";
  if (found->is_string()) return found->get<std::string>();
  return found->dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace softgrain::report
