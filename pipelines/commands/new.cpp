// softgrain new KIND: a small scene of a kind, every key with its meaning, other keys as comments.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "pipelines/commands/commands.h"
#include "pipelines/commands/key_text.h"
#include "pipelines/kinds/kinds.h"
#include "pipelines/law/terminal_plot.h"

namespace softgrain {

namespace {

constexpr std::size_t kSceneColumns = 100;

/// Lines that begin with "# ".
std::string scene_comment(const std::string& text) {
  std::string out;
  std::istringstream lines(law::wrapped(text, 0, kSceneColumns - 2));
  for (std::string line; std::getline(lines, line);) out += "# " + line + "\n";
  return out;
}

/// "number of bodies (whole number, from 1 to 10000000; default 200)".
std::string description_of(const ExploredKey& key) {
  if (key.is_table()) return key.asked.meaning;
  const std::string otherwise = default_text(key) == "-" ? "must be given" : "default " + default_text(key);
  return fmt::format("{} ({}; {})", key.asked.meaning, allowed_forms(key), otherwise);
}

/// "#bodies = 200": the line that sets a key to its default, out of use; without a value where that is no single one.
std::string idle_line(const ExploredKey& key) {
  if (key.is_table()) return "#" + written(key) + "\n";
  const bool plain = key.defaults.size() == 1 && key.asked.usual.empty() && key.defaults.front() != "\"\"";
  return fmt::format("#{} ={}\n", key.name, plain ? " " + key.defaults.front() : "");
}

std::vector<std::string> parts_of_path(const std::string& path) {
  std::vector<std::string> parts;
  std::istringstream text(path);
  for (std::string part; std::getline(text, part, '.');) parts.push_back(part);
  return parts;
}

/// Writes a scene of which each line has a table's name, a key with its value, a comment or nothing.
class CommentedScene {
 public:
  explicit CommentedScene(const SceneKind& kind) : kind_(kind), all_(keys_of(kind)) {}

  /// `everything`: also the keys of tables that the scene does without.
  std::string text(bool everything) {
    add_line(fmt::format("kind = \"{}\"", kind_.name));
    std::istringstream lines(kind_.starter);
    for (std::string line; std::getline(lines, line);) add_line(line);
    close_table();
    add_idle_tables(everything);
    return text_;
  }

 private:
  void add_line(const std::string& line) {
    if (line.starts_with('[')) {
      close_table();
      open_table(line);
    } else if (const std::size_t sign = line.find(" = "); sign != std::string::npos && !line.starts_with('#')) {
      given_.insert(line.substr(0, sign));
      for (const ExploredKey& key : in_table(all_, table_))
        if (fresh_ && key.name == line.substr(0, sign)) text_ += scene_comment(description_of(key));
    }
    text_ += line + "\n";
  }

  void open_table(const std::string& header) {
    const std::size_t begin = header.find_first_not_of('[');
    table_ = known_path(header.substr(begin, header.find(']') - begin));
    fresh_ = met_.insert(table_).second;
    text_ += "\n";
    if (fresh_) add_meaning_of_table();
  }

  /// Path of a table with NAME for a name that the scene chooses.
  [[nodiscard]] std::string known_path(const std::string& path) const {
    const std::vector<std::string> parts = parts_of_path(path);
    for (const ExploredKey& key : all_) {
      const std::vector<std::string> known = parts_of_path(key.path());
      if (key.is_table() && std::ranges::equal(parts, known, [](const std::string& a, const std::string& b) {
            return a == b || b == kFreeName;
          }))
        return key.path();
    }
    return path;
  }

  void add_meaning_of_table() {
    for (const ExploredKey& key : all_)
      if (key.is_table() && key.path() == table_ && !key.asked.meaning.empty())
        text_ += scene_comment(key.asked.meaning);
  }

  /// The keys of a table that were not given.
  void close_table() {
    if (fresh_)
      for (const ExploredKey& key : in_table(all_, table_)) {
        if (key.is_table() || key.name == kFreeName || given_.contains(key.name)) continue;
        text_ += scene_comment(description_of(key)) + idle_line(key);
      }
    given_.clear();
  }

  void add_idle_tables(bool everything) {
    const auto idle = [&](const ExploredKey& key) { return key.is_table() && !met_.contains(key.path()); };
    if (std::ranges::none_of(all_, idle)) return;
    if (!everything)
      text_ += "\n" + scene_comment(fmt::format("Tables that this scene does without; softgrain schema {} TABLE lists "
                                                "their keys:",
                                                kind_.name));
    for (const ExploredKey& key : all_) {
      if (!idle(key)) continue;
      if (everything) text_ += "\n";
      // Tables within others are named by their whole path.
      ExploredKey whole = key;
      whole.table.clear();
      whole.name = key.path();
      text_ += scene_comment(description_of(key)) + idle_line(whole);
      if (!everything || !met_.insert(key.path()).second) continue;
      table_ = key.path();
      fresh_ = true;
      close_table();
    }
  }

  const SceneKind& kind_;
  std::vector<ExploredKey> all_;
  std::string text_;
  std::string table_;            ///< the table that lines go to, as its keys name it; empty: the root
  std::set<std::string> given_;  ///< keys that it has so far
  std::set<std::string> met_;    ///< tables that are written
  bool fresh_ = true;            ///< whether it is the first one of its name, of which keys are explained
};

std::string heading_of_new(const SceneKind& kind, const std::string& file) {
  return scene_comment(fmt::format("Scene of kind \"{}\", written by softgrain new {}.", kind.name, kind.name)) +
         scene_comment(fmt::format("softgrain check {} says what it takes, softgrain run {} runs it.", file, file)) +
         scene_comment(
             "Lines without # are a small scene. A line that begins with # and no blank has a further key, with its "
             "default if that is one value: remove the # to change it.") +
         "\n";
}

}  // namespace

void add_new_command(CLI::App& app, NewOptions& o) {
  CLI::App* sub = app.add_subcommand("new", "A small scene of a kind to begin with, with all keys explained");
  sub->add_option("KIND", o.kind, "kind of scenes; without one: all kinds")->option_text(" ");
  sub->add_option("--out", o.out, "File to write, which must not be there; default standard output")
      ->option_text("FILE");
  sub->add_flag("--all", o.all, "Also the keys of tables that the scene does without");
  sub->callback([&o] { o.chosen = true; });
}

ExitStatus command_new(const NewOptions& o) {
  if (o.kind.empty()) {
    if (!o.out.empty()) throw InputError("--out: goes with a kind; softgrain new lists them");
    std::string list = "softgrain new KIND --out FILE: a small scene of a kind. Kinds:\n";
    for (const SceneKind& kind : scene_kinds()) list += fmt::format("  {}\n", kind.name);
    write_standard_output(list);
    return ExitStatus::good;
  }
  const SceneKind& kind = kind_named(o.kind, "new");
  const std::string file = o.out.empty() ? "FILE" : o.out;
  // The scene names files as if it stood among those that come with the program.
  const std::string text = with_full_paths(CommentedScene(kind).text(o.all), shipped_scenes());
  write_new_text(
      o.out, heading_of_new(kind, file) + text,
      fmt::format("{}: scene of kind {}; softgrain check {}, softgrain run {}\n", file, kind.name, file, file));
  return ExitStatus::good;
}

}  // namespace softgrain
