// Where the numbers came from: program, seeds, command and the whole scene.
#include "pipelines/report/html.h"
#include "pipelines/report/sections.h"

namespace softgrain::report {
namespace {

std::string rows(const nlohmann::json& provenance) {
  HtmlTable table({"what", "value"}, 2);
  for (const char* key : {"version", "commit", "compiler", "threads", "seed", "command"}) {
    const std::string value = find_text(provenance, key);
    if (!value.empty()) table.row({key, value});
  }
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
  std::string body = rows(provenance) + files(run.summary);
  const std::string scene = find_text(provenance, "scene");
  if (!scene.empty()) body += "<h3>Scene</h3>\n<pre>" + escape(scene) + "</pre>\n";
  return section("provenance", "Provenance", body);
}

}  // namespace softgrain::report
