#include "macrosim/lammps_run/lammps_log.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <span>
#include <sstream>
#include <vector>

#include "common/core/text.h"

namespace softgrain::lammps {

namespace {

constexpr std::uintmax_t kTail = 65536;
constexpr std::size_t kLastLines = 4;

}  // namespace

std::string LogTail::complaint() const {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    if (line.find("ERROR") != std::string::npos) return line;
    if (line.find_first_not_of(" -\t\r") != std::string::npos) lines.push_back(line);
  }
  const std::string out = join_text(std::span(lines).last(std::min(kLastLines, lines.size())), " | ");
  return out.empty() ? "its log is empty" : "its log ends with: " + out;
}

LogTail read_log(const std::string& path, std::uintmax_t begin) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return {};
  begin = std::max(begin, size > kTail ? size - kTail : 0);
  std::ifstream in(path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(begin));
  std::ostringstream text;
  text << in.rdbuf();
  return {text.str()};
}

}  // namespace softgrain::lammps
