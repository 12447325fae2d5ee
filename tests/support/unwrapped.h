// What a program said, long lines made whole again.
#pragma once

#include <string>

#include "common/io/text_file.h"

namespace softgrain::test {

/// Continued lines begin with four blanks.
inline std::string unwrapped(std::string text) {
  const std::string broken = "\n    ";
  for (std::size_t at = text.find(broken); at != std::string::npos; at = text.find(broken, at + 1))
    text.replace(at, broken.size(), " ");
  return text;
}

/// log.txt of a run; where it breaks a line depends on how long the paths are.
inline std::string log_of(const std::string& run_directory) { return unwrapped(read_text(run_directory + "/log.txt")); }

}  // namespace softgrain::test
