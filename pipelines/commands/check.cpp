// softgrain check: is this file sound, and what follows from it. Runs nothing that takes more than a moment.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "pipelines/commands/commands.h"
#include "pipelines/kinds/kinds.h"
#include "pipelines/kinds/law_table/scene.h"
#include "pipelines/run/run_context.h"

namespace softgrain {

namespace {

void check_scene(const std::string& path, const CommonOptions& options, Findings& out) {
  std::vector<std::string> overrides = options.overrides;
  if (options.seed_given) overrides.push_back(fmt::format("seed={}", options.seed));
  const Scene scene = Scene::load(path, overrides);
  const SceneKind& kind = kind_of(scene);
  out.add("kind", kind.name, std::string("scene of kind ") + kind.name);
  if (!options.law.empty() && !kind.takes_law) throw InputError("check: --law goes with scenes of kind \"macro\"");
  kind.check(scene, options, out);
}

/// Laws and scenes are both TOML; cards and tables of laws have a schema at the top.
bool holds_laws(const std::string& path) { return Scene::load(path).root().has("schema"); }

void check_file(const std::string& path, const CommonOptions& options, Findings& out) {
  std::error_code ignored;
  const auto form = file_form(path);
  const bool directory = std::filesystem::is_directory(path, ignored);
  const bool scene = !directory && (!form || form == FileForm::toml) && !holds_laws(path);
  const bool table = !directory && form && form != FileForm::toml && form != FileForm::hdf5 && form != FileForm::json;
  if (!scene && !table && !options.overrides.empty()) throw InputError("--set: " + path + " is no scene");
  if (!scene && options.seed_given) throw InputError("--seed: " + path + " is no scene");
  if (directory)
    check_directory(path, out);
  else if (form == FileForm::hdf5)
    check_data(path, out);
  else if (form == FileForm::json)
    check_summary(path, out);
  else if (table)
    check_table(path, options.overrides, out);
  else if (scene)
    check_scene(path, options, out);
  else
    check_laws(path, out);
}

/// What people read, without the indentation.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line.substr(std::min<std::size_t>(2, line.size())));
  return lines;
}

}  // namespace

ExitStatus command_check(const CommonOptions& options) {
  if (options.inputs.size() != 1) throw InputError("check: give one file");
  const std::string& path = options.inputs[0];
  Findings out;
  check_file(path, options, out);
  out.close_times();
  out.facts["status"] = "good";
  out.facts["warnings"] = out.warnings();
  if (options.json) {
    out.facts["lines"] = lines_of(out.lines);
    write_standard_output(out.facts.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
    return ExitStatus::good;
  }
  std::string text = path + ": OK\n" + out.lines;
  for (const std::string& warning : out.warnings()) text += "  warning: " + warning + "\n";
  write_standard_output(text);
  return ExitStatus::good;
}

}  // namespace softgrain
