#include "pipelines/commands/complaints.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <system_error>
#include <utility>
#include <vector>

#include "common/core/enum_names.h"
#include "common/io/progress.h"

namespace softgrain {

template <>
inline constexpr auto enum_names<ExitStatus> = enum_name_list<ExitStatus>({{ExitStatus::good, "good"},
                                                                           {ExitStatus::bad_input, "bad input"},
                                                                           {ExitStatus::not_usable, "not usable"},
                                                                           {ExitStatus::file_trouble, "file trouble"},
                                                                           {ExitStatus::interrupted, "interrupted"}});

namespace {

using nlohmann::json;

/// What the parts of our messages are: "key = value: what is wrong, what is allowed; nearest is ...".
struct Form {
  const char* name;
  std::regex text;
};

const std::vector<Form>& forms() {
  static const std::vector<Form> known{
      {"setting", std::regex("\\(--set ([^)]+)\\)")},
      {"key", std::regex("^(?:unknown key |missing key )'([^']+)'")},
      {"key", std::regex("^([A-Za-z_][A-Za-z0-9_.-]*)(?: = [^:]*)?: ")},
      {"value", std::regex("^[A-Za-z_][A-Za-z0-9_.-]* = (\"[^\"]*\"|[^:]*): ")},
      {"table", std::regex("^(?:unknown key|missing key) '[^']+' in \\[+([^\\]]+)\\]")},
      {"allowed", std::regex("(known (?:keys )?are [^;]+)")},
      {"allowed", std::regex("(must be [^;]+)")},
      {"nearest", std::regex("nearest (?:known key )?is ['\"]([^'\"]+)['\"]")},
      {"nearest", std::regex("did '([^']+)' at .* mean it\\?")}};
  return known;
}

/// False for a number that is too large: it is none of a line.
bool is_whole(const std::string& digits, std::int64_t& number) {
  return std::from_chars(digits.data(), digits.data() + digits.size(), number).ec == std::errc{};
}

json error_object(const std::string& text) {
  static const std::regex placed("^([^:]+):([0-9]+): (.*)$");
  static const std::regex set("^([^:]+ \\(--set [^)]+\\)): (.*)$");
  std::smatch parts;
  json out;
  std::int64_t line = 0;
  if (std::regex_match(text, parts, placed) && is_whole(parts[2].str(), line))
    out = {{"file", parts[1].str()}, {"line", line}, {"message", parts[3].str()}};
  else
    out = {{"message", text}};
  const std::string message = std::regex_match(text, parts, set) ? parts[2].str() : out["message"].get<std::string>();
  for (const Form& form : forms()) {
    const std::string& where = form.name == std::string("setting") ? text : message;
    if (!out.contains(form.name) && std::regex_search(where, parts, form.text)) out[form.name] = parts[1].str();
  }
  return out;
}

}  // namespace

nlohmann::json error_objects(const std::string& messages) {
  json errors = json::array();
  std::istringstream lines(messages);
  for (std::string one; std::getline(lines, one);) errors.push_back(error_object(one));
  return errors;
}

int complain(ExitStatus status, const std::string& messages, bool as_json) {
  const int number = static_cast<int>(status);
  log_text(messages);
  log_text(fmt::format("ended with status {} ({})", number, to_string(status)));
  std::istringstream lines(messages);
  // Not by fmt: it throws where standard error cannot be written, and the status is what is left to tell then.
  for (std::string one; std::getline(lines, one);) (void)std::fputs(("softgrain: " + one + "\n").c_str(), stderr);
  if (!as_json) return number;
  const json all{{"status", to_string(status)}, {"exit_status", number}, {"errors", error_objects(messages)}};
  const std::string text = all.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
  (void)std::fputs(text.c_str(), stdout);
  (void)std::fflush(stdout);
  return number;
}

FreshDirectory::FreshDirectory(std::string path) : path_(std::move(path)) {
  std::error_code ignored;
  for (std::filesystem::path part = path_; !part.empty() && !std::filesystem::exists(part, ignored);
       part = part.parent_path())
    ++made_;
}

void FreshDirectory::remove_if_empty() const {
  std::filesystem::path part = path_;
  std::error_code trouble;
  for (int k = 0; k < made_; ++k, part = part.parent_path())
    if (!std::filesystem::remove(part, trouble) || trouble) return;
}

}  // namespace softgrain
