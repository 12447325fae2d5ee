// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <string_view>
#include <vector>

#include "common/core/error.h"
#include "common/io/toml.h"

namespace softgrain {

namespace {

/// Goes through a text once, from one place to the next that says something about keys.
class KeyScan {
 public:
  explicit KeyScan(std::string_view text) : text_(text) {}

  std::size_t line_of_long_key(std::size_t most) {
    std::size_t dots = 0;
    for (; at_ < text_.size(); ++at_) {
      if (text_[at_] == '"' || text_[at_] == '\'') skip_string(text_[at_]);
      if (at_ < text_.size() && text_[at_] == '#') skip_comment();
      if (at_ >= text_.size()) break;
      const char c = text_[at_];
      if (c == '.' && ++dots >= most) return line_;
      if (ends_key(c)) dots = 0;
      if (c == '\n') ++line_;
    }
    return 0;
  }

 private:
  static bool ends_key(char c) { return std::string_view("=,[]{}\n").find(c) != std::string_view::npos; }

  /// Ends on the last character of the string, or on the end of the line that a string of one line lacks its end in.
  void skip_string(char quote) {
    const bool many_lines = at_ + 2 < text_.size() && text_[at_ + 1] == quote && text_[at_ + 2] == quote;
    const std::size_t marks = many_lines ? 3 : 1;
    std::size_t seen = 0;
    for (at_ += marks; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\n' && !many_lines) return;
      if (c == '\n') ++line_;
      seen = c == quote ? seen + 1 : 0;
      if (seen == marks) return;
      if (c == '\\' && quote == '"' && at_ + 1 < text_.size() && text_[at_ + 1] != '\n') ++at_;
    }
  }

  /// Ends on the end of the line.
  void skip_comment() {
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

bool meets_assertion(std::string_view text) {
  try {
    (void)toml::parse(text);
  } catch (const TomlAssertion&) {
    return true;
  } catch (const toml::parse_error&) {  // cut off too early
  }
  return false;
}

/// Where a text stands that toml++ meets with an assertion: the first line with which the text up to there does.
std::size_t line_of_assertion(const std::string& text) {
  std::vector<std::size_t> ends;
  for (std::size_t k = 0; k < text.size(); ++k)
    if (text[k] == '\n') ends.push_back(k + 1);
  const auto found = std::partition_point(ends.begin(), ends.end(), [&](std::size_t end) {
    return !meets_assertion(std::string_view(text).substr(0, end));
  });
  return static_cast<std::size_t>(found - ends.begin()) + 1;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// The line of this number, from 1; empty where there is none.
std::string_view line_of_text(std::string_view text, std::size_t number) {
  for (; number > 1; --number) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

/// What people who do not know TOML write: 0,5 for 0.5, a unit without quotation marks, a text whose end is missing.
/// "; how it is written", or nothing.
std::string usual_slip(std::string_view line) {
  if (line.find("\"\"\"") == std::string_view::npos && std::ranges::count(line, '"') % 2 == 1)
    return "; a quotation mark is not closed";
  const std::size_t mark = line.find('=');
  if (mark == std::string_view::npos) return "";
  std::string_view value = line.substr(mark + 1);
  value.remove_prefix(std::min(value.find_first_not_of(" \t[+-"), value.size()));
  if (value.empty() || !is_digit(value.front())) return "";
  value.remove_prefix(std::min(value.find_first_not_of("0123456789._"), value.size()));
  if (value.size() > 1 && value[0] == ',' && is_digit(value[1])) return "; numbers have a decimal point: 0.5, not 0,5";
  value.remove_prefix(std::min(value.find_first_not_of(" \t"), value.size()));
  const bool unit = !value.empty() && std::string_view(",]#\r\"").find(value.front()) == std::string_view::npos;
  return unit ? "; a number with a unit is written in quotation marks, as in \"16 mm\"" : "";
}

}  // namespace

std::size_t line_of_long_key(std::string_view text, std::size_t most) { return KeyScan(text).line_of_long_key(most); }

toml::table parse_toml(const std::string& text, const std::string& name) {
  if (const std::size_t line = line_of_long_key(text); line > 0)
    throw InputError(name + ":" + std::to_string(line) + ": a key of more than " + std::to_string(kMostKeyParts) +
                     " parts");
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& e) {
    const std::size_t line = e.source().begin.line;
    throw InputError(name + ":" + std::to_string(line) + ": not valid TOML: " + std::string(e.description()) +
                     usual_slip(line_of_text(text, line)));
  } catch (const TomlAssertion&) {
    throw InputError(name + ":" + std::to_string(line_of_assertion(text)) +
                     ": not valid TOML: a key must begin with a letter, a digit, '_', '-' or a quotation mark");
  }
}

}  // namespace softgrain
