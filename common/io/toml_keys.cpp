// SPDX-License-Identifier: BSD-3-Clause
#include "common/io/toml_keys.h"

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

}  // namespace

std::size_t line_of_long_key(std::string_view text, std::size_t most) { return KeyScan(text).line_of_long_key(most); }

}  // namespace softgrain
