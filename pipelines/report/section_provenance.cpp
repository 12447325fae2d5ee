// Where the numbers came from: program, seeds, command and the whole scene.
#include "pipelines/report/html.h"
#include "pipelines/report/sections.h"

namespace softgrain::report {
namespace {

/// "LAMMPS 29 Sep 2021, 4 ranks", where it was not our own engine.
std::string engine_of(const nlohmann::json& summary) {
  const auto* engine = find_value(summary, "engine");
  if (engine == nullptr || find_text(*engine, "name") != "lammps") return "";
  const auto* ranks = find_value(*engine, "ranks");
  return "LAMMPS " + find_text(*engine, "lammps") + ", ranks: " + (ranks != nullptr ? ranks->dump() : "unknown");
}

std::string rows(const nlohmann::json& provenance, const std::string& engine) {
  HtmlTable table({"what", "value"}, 2);
  for (const char* key : {"version", "commit", "compiler", "threads", "seed", "command"}) {
    const std::string value = find_text(provenance, key);
    if (!value.empty()) table.row({key, value});
  }
  if (!engine.empty()) table.row({"engine", engine});
  return table.empty() ? "" : table.html();
}

std::string files(const nlohmann::json& summary) {
  const auto* list = find_value(summary, "files");
  if (list == nullptr || !list->is_object() || list->empty()) return "";
  HtmlTable table({"file", "path"}, 2);
  for (const auto& [name, path] : list->items())
    table.row({name, path.is_string() ? path.get<std::string>() : path.dump()});
  return table.html();
}

}  // namespace

std::string provenance_section(const RunData& run) {
  const auto* found = find_value(run.summary, "provenance");
  const nlohmann::json& provenance = found != nullptr ? *found : run.summary;
  std::string body = rows(provenance, engine_of(run.summary)) + files(run.summary);
  const std::string scene = find_text(provenance, "scene");
  if (!scene.empty()) body += "<h3>Scene</h3>\n<pre>" + escape(scene) + "</pre>\n";
  return section("provenance", "Provenance", body);
}

}  // namespace softgrain::report
