// Words of the command line that are about commands: help and version, and options that no command knows.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "common/core/text.h"
#include "common/io/provenance.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"
#include "pipelines/commands/commands.h"

namespace softgrain {

namespace {

/// "--out", "--threads": all long options of a command.
std::vector<std::string> options_of_command(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// Commands that know an option.
std::string commands_with(const CLI::App& program, const std::string& option) {
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; }))
    if (std::ranges::count(options_of_command(*command), option) > 0) names.push_back(command->get_name());
  return join_text(names);
}

std::string unknown_option_text(const CLI::App& program, const CLI::App& command, const std::string& option) {
  const std::string near = nearest_text(option, options_of_command(command));
  const std::string others = commands_with(program, option);
  const std::string given = command_on_line(program);
  const std::string text =
      fmt::format("{}: {} has no such option", option, given.empty() ? "softgrain" : trimmed(given));
  if (!others.empty()) return text + "; commands with it are " + others;
  return near.empty() ? text : text + "; " + near;
}

}  // namespace

std::string version_text() {
  const Provenance build = build_provenance();
  return "softgrain " + build.version + " (" + build.commit + ")";
}

void add_help_commands(CLI::App& app, bool& version) {
  CLI::App* help = app.add_subcommand("help", "The commands, or the options of one: as softgrain COMMAND --help");
  help->add_option("COMMAND", "command to explain")->option_text(" ");
  app.add_subcommand("version", "Version and commit of the program")->callback([&version] { version = true; });
}

std::vector<std::string> without_help_command(std::vector<std::string> words) {
  const bool asked = words.size() > 1 && words[1] == "help" && (words.size() == 2 || !words[2].starts_with('-'));
  if (!asked) return words;
  words.erase(words.begin() + 1);
  words.emplace_back("--help");
  return words;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

std::string command_on_line(const CLI::App& app) {
  const std::vector<CLI::App*> parsed = app.get_subcommands();
  return parsed.empty() ? "" : parsed.front()->get_name() + " " + command_on_line(*parsed.front());
}

std::string unknown_command_text(const std::string& given, const std::string& hint,
                                 const std::vector<std::string>& known) {
  return fmt::format("unknown command '{}'; {}commands are {}", given, hint.empty() ? "" : hint + "; ",
                     join_text(known));
}

namespace {

/// The option that ends the line or has the name of another option for its value; null: there is none.
const CLI::Option* option_without_value(const CLI::App& command, const std::string& message) {
  if (message.starts_with("--") && message.find(" required ") != std::string::npos)
    return command.get_option_no_throw(message.substr(0, message.find(':')));
  for (const CLI::Option* option : command.get_options())
    for (const std::string& value : option->results())
      if (value.starts_with("--") && command.get_option_no_throw(value) != nullptr) return option;
  return nullptr;
}

}  // namespace

std::string missing_value_text(const CLI::App& program, const std::string& message) {
  const CLI::App* command = &program;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  const CLI::Option* option = option_without_value(*command, message);
  if (option == nullptr || option->get_option_text().empty()) return "";
  return fmt::format("{0}: nothing follows it; give {0} {1}: {2}", option->get_name(), option->get_option_text(),
                     option->get_description());
}

std::string unknown_word_text(const CLI::App& program) {
  const CLI::App* command = &program;
  while (command->remaining_size() == 0 && !command->get_subcommands().empty())
    command = command->get_subcommands().front();
  for (const std::string& word : command->remaining()) {
    if (word.starts_with('-') && word != "-" && word != "--")
      return unknown_option_text(program, *command, word.substr(0, word.find('=')));
    const std::vector<std::string> parts = command_names(*command);
    if (parts.empty()) continue;
    return unknown_command_text(command_on_line(program) + word, nearest_text(word, parts), parts);
  }
  return "";
}

}  // namespace softgrain
