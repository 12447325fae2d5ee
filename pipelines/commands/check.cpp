// softgrain check: is this file sound, and what follows from it. Runs nothing that takes more than a moment.
#include <fmt/format.h>
#include <omp.h>

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
  refuse_idle_options(kind, options);
  kind.check(scene, options, out);
}

/// What is said of a scene; --set says how a table is read, too.
void refuse_scene_options(const std::string& path, const CommonOptions& options, bool table) {
  const std::string what = ": " + path + " is no scene";
  if (!table && !options.overrides.empty()) throw InputError("--set" + what);
  if (options.seed_given) throw InputError("--seed" + what);
  if (!options.law.empty()) throw InputError("--law" + what);
  if (options.bands > 0) throw InputError("--bands" + what);
}

/// Laws and scenes are both TOML; cards and tables of laws have a schema at the top.
bool holds_laws(const std::string& path) { return Scene::load(path).root().has("schema"); }

void check_file(const std::string& path, const CommonOptions& options, Findings& out) {
  std::error_code ignored;
  const auto form = file_form(path);
  const bool directory = std::filesystem::is_directory(path, ignored);
  const bool scene = !directory && (!form || form == FileForm::toml) && !holds_laws(path);
  const bool table = !directory && form && form != FileForm::toml && form != FileForm::hdf5 && form != FileForm::json;
  if (!scene) refuse_scene_options(path, options, table);
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
  if (options.threads > 0) omp_set_num_threads(options.threads);
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
