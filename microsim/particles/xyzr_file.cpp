#include "microsim/particles/xyzr_file.h"

#include <zlib.h>

#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <string_view>

#include "common/core/error.h"

namespace softgrain {

namespace {

/// The whole file; zlib passes plain files through.
std::string read_unpacked(const std::string& path) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), gzclose);
  if (!file) throw FileTrouble(path + ": no such file, or it cannot be read");
  std::string text;
  std::array<char, 65536> buffer{};
  for (;;) {
    const int got = gzread(file.get(), buffer.data(), buffer.size());
    if (got > 0) text.append(buffer.data(), static_cast<std::size_t>(got));
    if (got == static_cast<int>(buffer.size())) continue;
    int status = Z_OK;
    const char* why = gzerror(file.get(), &status);
    if (got < 0 || status != Z_OK) throw FileTrouble(path + ": damaged or cut short (" + std::string(why) + ")");
    return text;
  }
}

[[noreturn]] void wrong(const std::string& path, std::int64_t line, const std::string& problem) {
  throw BadInput(path + ":" + std::to_string(line) + ": " + problem);
}

/// Four numbers separated by blanks or tabs, all finite, and nothing else.
std::array<double, 4> four_numbers(std::string_view line, const std::string& path, std::int64_t number,
                                   const char* what) {
  constexpr std::string_view kBlank = " \t\r";
  std::array<double, 4> out{};
  for (double& value : out) {
    line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    if (error != std::errc{} || !std::isfinite(value))
      wrong(path, number, "must be four finite numbers, " + std::string(what));
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  }
  if (line.find_first_not_of(kBlank) != std::string_view::npos)
    wrong(path, number, "must be four numbers, " + std::string(what));
  return out;
}

/// Cuts the first line off `rest`.
std::string_view next_line(std::string_view& rest) {
  const std::size_t end = std::min(rest.find('\n'), rest.size());
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return line;
}

std::size_t count_of(double n, const std::string& path) {
  if (!(n >= 1.0) || n > 1e8 || n != std::floor(n)) wrong(path, 1, "N must be a whole number from 1 to 1e8");
  return static_cast<std::size_t>(n);
}

}  // namespace

XyzrFile read_xyzr(const std::string& path) {
  const std::string text = read_unpacked(path);
  std::string_view rest = text;
  const auto head = four_numbers(next_line(rest), path, 1, "N Lx Ly Lz");
  XyzrFile file;
  file.box = {{head[1], head[2], head[3]}};
  const std::size_t n = count_of(head[0], path);
  for (std::size_t k = 0; k < n; ++k) {
    const std::int64_t line = xyzr_line(k);
    if (rest.empty())
      wrong(path, line, "the file ends after " + std::to_string(k) + " of " + std::to_string(n) + " spheres");
    const auto v = four_numbers(next_line(rest), path, line, "x y z r");
    if (!(v[3] > 0.0)) wrong(path, line, "r = " + std::to_string(v[3]) + ": must be above 0");
    file.position.push_back({{v[0], v[1], v[2]}});
    file.radius.push_back(v[3]);
  }
  if (rest.find_first_not_of(" \t\r\n") != std::string_view::npos)
    wrong(path, xyzr_line(n), "more lines than the " + std::to_string(n) + " spheres of the first line");
  return file;
}

}  // namespace softgrain
