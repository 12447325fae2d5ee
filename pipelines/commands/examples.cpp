// softgrain examples: the scenes that come with the program, listed or copied.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/child_process.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"
#include "pipelines/commands/commands.h"
#include "pipelines/law/terminal_plot.h"

namespace softgrain {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kFirstExample = "quickstart.toml";  ///< a folder with this scene is that of all
constexpr std::size_t kLongestTime = 130;  ///< characters of a sentence about time; longer ones are about more

/// What the list says of a scene.
struct Example {
  std::string name;
  std::string kind;
  std::string title;
  std::string time;  ///< the sentence of its heading that says how long it takes; empty: none does
};

/// The comment that a scene begins with, as one line.
std::string heading_of(const std::string& scene) {
  std::string heading;
  std::istringstream lines(scene);
  for (std::string line; std::getline(lines, line) && line.starts_with('#');)
    append_part(heading, trimmed(line.substr(1)), " ");
  return heading;
}

/// The first short sentence of a heading that speaks of seconds, minutes or hours.
std::string time_said(const std::string& heading) {
  static const std::regex time("\\b([Ss]econds?|[Mm]inutes?|[Hh]ours?)\\b");
  for (std::size_t at = 0; at < heading.size();) {
    const std::size_t end = std::min(heading.find(". ", at), heading.size());
    const std::string sentence = heading.substr(at, end + 1 - at);
    if (sentence.size() <= kLongestTime && std::regex_search(sentence, time)) return sentence;
    at = end + 2;
  }
  return "";
}

std::string folder_of_examples() {
  const std::string folder = shipped_scenes();
  if (folder.empty())
    throw IoError("examples: no scenes are installed beside this program (share/softgrain/pipelines)");
  return folder;
}

Example example_of(const fs::path& file) {
  const std::string text = read_text(file.string());
  const SceneTable root = Scene::parse(text, file.string()).root();
  return {file.stem().string(), root.text("kind", ""), root.text("title", ""), time_said(heading_of(text))};
}

/// The scenes of a folder, by name.
std::vector<fs::path> scenes_in(const std::string& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<Example> examples_in(const std::string& folder) {
  std::vector<Example> examples;
  std::ranges::transform(scenes_in(folder), std::back_inserter(examples), example_of);
  return examples;
}

std::string list_of_examples(const std::vector<Example>& examples, const std::string& folder) {
  std::string text = fmt::format("softgrain examples NAME --out FILE copies one of these scenes of {}:\n", folder);
  for (const Example& e : examples) {
    text += law::wrapped(fmt::format("{} ({}): {}", e.name, e.kind, e.title), 4, law::kTerminalColumns);
    if (!e.time.empty()) text += law::wrapped("    " + e.time, 4, law::kTerminalColumns);
  }
  return text;
}

json json_of_examples(const std::vector<Example>& examples, const std::string& folder) {
  json list = json::array();
  for (const Example& e : examples)
    list.push_back({{"name", e.name},
                    {"kind", e.kind},
                    {"title", e.title},
                    {"time", e.time},
                    {"file", folder + "/" + e.name + ".toml"}});
  return {{"command", "examples"}, {"status", "good"}, {"examples", list}};
}

/// The file of an example; its name may end with .toml.
std::string file_of_example(const std::string& name, const std::string& folder) {
  const std::string stem = name.ends_with(".toml") ? name.substr(0, name.size() - 5) : name;
  std::vector<std::string> names;
  for (const fs::path& file : scenes_in(folder)) names.push_back(file.stem().string());
  if (std::ranges::count(names, stem) > 0) return folder + "/" + stem + ".toml";
  throw InputError(
      fmt::format("examples {}: no such scene; {}", name, nearest_text(stem, names, "softgrain examples lists them")));
}

/// A line with the paths between its quotes made full; what follows a # beyond quotes stays.
std::string with_full_paths_in_line(const std::string& line, const fs::path& folder) {
  std::string out;
  std::size_t at = 0;
  while (at < line.size()) {
    const std::size_t begin = line.find_first_of("\"#", at);
    const std::size_t end = begin == std::string::npos || line[begin] == '#' ? begin : line.find('"', begin + 1);
    if (end == std::string::npos || line[begin] == '#') break;
    const std::string word = line.substr(begin + 1, end - begin - 1);
    const fs::path file = (folder / word).lexically_normal();
    std::error_code ignored;
    const bool named = !word.empty() && fs::path(word).is_relative() && fs::is_regular_file(file, ignored);
    const json full = named ? file.string() : word;
    out += line.substr(at, begin - at) +
           (named ? full.dump(-1, ' ', false, json::error_handler_t::replace) : "\"" + word + "\"");
    at = end + 1;
  }
  return out + line.substr(at);
}

}  // namespace

std::string shipped_scenes() {
  std::error_code error;
  for (fs::path at = own_directory(); at.has_relative_path(); at = at.parent_path())
    for (const char* place : {"share/softgrain/pipelines", "pipelines"})
      if (fs::exists(at / place / kFirstExample, error)) return (at / place).string();
  return "";
}

namespace {

/// The file of the program whose path ends as this one does, in as many parts as possible; empty: there is none.
std::string shipped_counterpart(const fs::path& path) {
  const std::string folder = shipped_scenes();
  if (folder.empty()) return "";
  std::error_code ignored;
  for (fs::path end = path.relative_path(); !end.empty();) {
    for (const fs::path& root : {fs::path(folder), fs::path(folder).parent_path()})
      if (fs::is_regular_file(root / end, ignored)) return (root / end).string();
    fs::path shorter;
    for (auto part = std::next(end.begin()); part != end.end(); ++part) shorter /= *part;
    end = shorter;
  }
  return "";
}

/// A file of the working directory that was meant, where the scene lies elsewhere: `--set file=...` is read relative to
/// the scene. Its full path; empty: there is none.
std::string counterpart_here(const std::string& path, const std::vector<std::string>& words) {
  std::error_code ignored;
  for (const std::string& word : words) {
    if (!word.ends_with(".toml")) continue;
    const fs::path within = fs::path(path).lexically_relative(fs::path(word).parent_path());
    if (!within.empty() && fs::is_regular_file(within, ignored)) return fs::absolute(within, ignored).string();
  }
  return "";
}

/// Whether a scene among these words may have named the file: it lies in the scene's folder, or below.
bool is_beside_a_scene(const std::string& path, const std::vector<std::string>& words) {
  return std::ranges::any_of(words, [&](const std::string& word) {
    return word != path && word.ends_with(".toml") && path.starts_with(fs::path(word).parent_path().string());
  });
}

std::string about_missing_file(const std::string& path, const std::vector<std::string>& words) {
  std::string shipped = shipped_counterpart(path);
  if (shipped.empty()) shipped = shipped_counterpart(path + ".toml");
  std::string text = shipped.empty() ? "" : "; one of this name comes with the program: " + shipped;
  if (fs::path(shipped).extension() == ".toml" && fs::path(shipped).parent_path() == fs::path(shipped_scenes()))
    text += fmt::format(" (softgrain examples {} --out FILE copies it)", fs::path(shipped).stem().string());
  if (std::ranges::find(words, path) != words.end() || !is_beside_a_scene(path, words)) return text;
  text += "; paths in a scene are relative to its own folder";
  if (const std::string here = counterpart_here(path, words); !here.empty())
    text += fmt::format(", also with --set; the file in the working directory is {}", here);
  else if (!shipped.empty())
    text += ": name that file, or copy the scene with softgrain examples NAME --out FILE, which does";
  return text;
}

}  // namespace

std::string with_missing_files_explained(const std::string& messages, const std::vector<std::string>& words) {
  constexpr std::string_view kMissing = ": no such file";
  std::string text;
  std::istringstream lines(messages);
  for (std::string line; std::getline(lines, line);) {
    if (line.ends_with(kMissing)) line += about_missing_file(line.substr(0, line.size() - kMissing.size()), words);
    append_part(text, line, "\n");
  }
  return text;
}

std::string with_full_paths(const std::string& scene, const std::string& folder) {
  std::string text;
  std::istringstream lines(scene);
  for (std::string line; std::getline(lines, line);) text += with_full_paths_in_line(line, folder) + "\n";
  return text;
}

void refuse_to_overwrite(const std::string& path, const std::string& advice) {
  std::error_code error;
  if (fs::symlink_status(path, error).type() != fs::file_type::not_found)
    throw InputError("--out " + path + ": is there already and would be overwritten; " + advice);
}

void write_new_text(const std::string& path, const std::string& text, const std::string& told) {
  if (path.empty()) {
    write_standard_output(text);
    return;
  }
  refuse_to_overwrite(path);
  write_text_atomic(path, text);
  write_standard_output(told);
}

void add_examples_command(CLI::App& app, ExampleOptions& o) {
  CLI::App* sub = app.add_subcommand("examples", "The scenes that come with the program; with a name: a copy of one");
  sub->add_option("NAME", o.name, "scene to copy; without one: the list")->option_text(" ");
  sub->add_option("--out", o.out, "File to write, which must not be there; default standard output")
      ->option_text("FILE");
  sub->add_flag("--json", o.json, "The list as one JSON object");
  sub->callback([&o] { o.chosen = true; });
}

ExitStatus command_examples(const ExampleOptions& o) {
  const std::string folder = folder_of_examples();
  if (!o.name.empty()) {
    if (o.json) throw InputError("--json: goes with the list of scenes, without the name of one");
    const std::string file = file_of_example(o.name, folder);
    write_new_text(o.out, with_full_paths(read_text(file), folder), fmt::format("{}: copy of {}\n", o.out, file));
    return ExitStatus::good;
  }
  if (!o.out.empty()) throw InputError("--out: goes with the name of a scene; softgrain examples lists them");
  const std::vector<Example> examples = examples_in(folder);
  write_standard_output(
      o.json ? json_of_examples(examples, folder).dump(2, ' ', false, json::error_handler_t::replace) + "\n"
             : list_of_examples(examples, folder));
  return ExitStatus::good;
}

}  // namespace softgrain
