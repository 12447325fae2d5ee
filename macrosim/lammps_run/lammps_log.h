// The end of a log of LAMMPS, when something went wrong.
#pragma once

#include <cstdint>
#include <string>

namespace softgrain::lammps {

struct LogTail {
  std::string text;

  [[nodiscard]] bool says(const std::string& words) const { return text.find(words) != std::string::npos; }
  /// The first line with "ERROR", else the last lines; on one line.
  [[nodiscard]] std::string complaint() const;
};

/// What stands beyond `begin`, at most the last 64 kB of it.
LogTail read_log(const std::string& path, std::uintmax_t begin);

}  // namespace softgrain::lammps
