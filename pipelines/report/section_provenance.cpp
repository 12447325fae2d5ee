// Where the numbers came from: program, seeds, command and the whole scene.
#include <fmt/format.h>

#include "pipelines/report/html.h"
#include "pipelines/report/sections.h"
#include "pipelines/results/summary.h"

namespace softgrain::report {
namespace {

/// "LAMMPS 29 Sep 2021, ranks: 4", where it was not our own engine.
std::string engine_of(const std::optional<EngineUse>& engine) {
  if (!engine || engine->name != MacroEngine::lammps) return "";
  return fmt::format("LAMMPS {}, ranks: {}", engine->release, engine->ranks);
}

std::string rows(const AnySummary& summary, const std::string& engine) {
  HtmlTable table({"what", "value"}, 2);
  const auto add = [&](const char* what, const std::string& value) {
    if (!value.empty()) table.row({what, value});
  };
  Provenance said;  // what summaries without a provenance say
  said.version = summary.version;
  said.commit = summary.commit;
  said.command = summary.command;
  const Provenance p = summary.provenance.value_or(said);
  add("version", p.version);
  add("commit", p.commit);
  add("compiler", p.compiler);
  if (summary.provenance) {
    add("threads", std::to_string(p.threads));
    add("seed", std::to_string(p.seed));
  }
  add("command", p.command);
  add("engine", engine);
  return table.empty() ? "" : table.html();
}

std::string files(const AnySummary& summary) {
  HtmlTable table({"file", "path"}, 2);
  for (const auto& [name, path] : summary.files) table.row({name, path});
  return table.empty() ? "" : table.html();
}

}  // namespace

std::string provenance_section(const RunData& run) {
  const auto summary = run.summary_as<AnySummary>();
  std::string body = rows(summary, engine_of(summary.engine)) + files(summary);
  if (summary.provenance && !summary.provenance->scene.empty())
    body += "<h3>Scene</h3>\n<pre>" + escape(summary.provenance->scene) + "</pre>\n";
  return section("provenance", "Provenance", "Everything that is needed to repeat this run.", body);
}

}  // namespace softgrain::report
