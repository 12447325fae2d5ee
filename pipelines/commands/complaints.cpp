#include "pipelines/commands/complaints.h"

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <system_error>
#include <utility>

#include "common/core/words.h"

namespace softgrain {

template <>
inline constexpr auto words<ExitStatus> = word_list<ExitStatus>({{ExitStatus::good, "good"},
                                                                 {ExitStatus::bad_input, "bad input"},
                                                                 {ExitStatus::not_usable, "not usable"},
                                                                 {ExitStatus::file_trouble, "file trouble"},
                                                                 {ExitStatus::interrupted, "interrupted"}});

namespace {

using nlohmann::json;

json error_object(const std::string& text) {
  static const std::regex placed("^([^:]+):([0-9]+): (.*)$");
  std::smatch parts;
  if (!std::regex_match(text, parts, placed)) return {{"message", text}};
  return {{"file", parts[1].str()}, {"line", std::stol(parts[2].str())}, {"message", parts[3].str()}};
}

}  // namespace

int complain(ExitStatus status, const std::string& messages, bool as_json) {
  const int number = static_cast<int>(status);
  json errors = json::array();
  std::istringstream lines(messages);
  for (std::string one; std::getline(lines, one);) {
    // Not by fmt: it throws where standard error cannot be written, and the status is what is left to tell then.
    (void)std::fputs(("softgrain: " + one + "\n").c_str(), stderr);
    errors.push_back(error_object(one));
  }
  if (!as_json) return number;
  const json all{{"status", to_string(status)}, {"exit_status", number}, {"errors", errors}};
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
