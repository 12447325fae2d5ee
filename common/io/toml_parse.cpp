// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <string_view>
#include <vector>

#include "common/core/error.h"
#include "common/io/toml.h"
#include "common/io/toml_keys.h"

namespace softgrain {

namespace {

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

}  // namespace

toml::table parse_toml(const std::string& text, const std::string& name) {
  if (const std::size_t line = line_of_long_key(text); line > 0)
    throw InputError(name + ":" + std::to_string(line) + ": a key of more than " + std::to_string(kMostKeyParts) +
                     " parts");
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& e) {
    throw InputError(name + ":" + std::to_string(e.source().begin.line) +
                     ": not valid TOML: " + std::string(e.description()));
  } catch (const TomlAssertion&) {
    throw InputError(name + ":" + std::to_string(line_of_assertion(text)) +
                     ": not valid TOML: a key must begin with a letter, a digit, '_', '-' or a quotation mark");
  }
}

}  // namespace softgrain
