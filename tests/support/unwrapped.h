// What a program said, long lines made whole again.
#pragma once

#include <string>

namespace softgrain::test {

/// Continued lines begin with four blanks.
inline std::string unwrapped(std::string text) {
  const std::string broken = "\n    ";
  for (std::size_t at = text.find(broken); at != std::string::npos; at = text.find(broken, at + 1))
    text.replace(at, broken.size(), " ");
  return text;
}

}  // namespace softgrain::test
