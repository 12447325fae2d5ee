#include "macrosim/lammps_run/dump_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <vector>

#include "common/core/error.h"
#include "common/core/text.h"

namespace softgrain::lammps {

namespace {

/// A dump with one state, read line by line: files of a million bodies are long.
class Dump {
 public:
  explicit Dump(const std::string& path) : path_(path), in_(path) {
    if (!in_) throw IoError(path + ": cannot be read");
  }

  std::string line() {
    std::string text;
    if (!std::getline(in_, text) || in_.eof()) throw IoError(path_ + ": cut short");
    ++number_;
    return text;
  }

  void expect(const std::string& begin) {
    if (!line().starts_with(begin)) refuse("'" + begin + "' expected");
  }

  /// All numbers of the next line.
  void numbers(std::vector<double>& out) {
    const std::string text = line();
    out.clear();
    const char* at = text.data();
    const char* const end = at + text.size();
    for (;;) {
      while (at != end && (*at == ' ' || *at == '\t')) ++at;
      if (at == end) return;
      double x = 0.0;
      const auto [next, error] = std::from_chars(at, end, x);
      if (error != std::errc{} || (next != end && *next != ' ' && *next != '\t') || !std::isfinite(x))
        refuse("something that is no finite number");
      out.push_back(x);
      at = next;
    }
  }

  std::vector<double> numbers(std::size_t count) {
    std::vector<double> out;
    numbers(out);
    if (out.size() != count) refuse(fmt::format("{} numbers, {} expected", out.size(), count));
    return out;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw IoError(fmt::format("{}, line {}: {}", path_, number_, what));
  }

 private:
  std::string path_;
  std::ifstream in_;
  std::int64_t number_ = 0;
};

struct DumpHead {
  Vec3 low{};
  Vec3 high{};
  double entries = 0.0;
};

/// Heads of the one state in a dump, up to the line that names its columns.
DumpHead read_head(Dump& dump, const std::string& what) {
  DumpHead head;
  dump.expect("ITEM: TIMESTEP");
  (void)dump.numbers(1);
  dump.expect("ITEM: NUMBER OF " + what);
  head.entries = dump.numbers(1)[0];
  dump.expect("ITEM: BOX BOUNDS");
  for (int k = 0; k < 3; ++k) {
    const auto bounds = dump.numbers(2);
    head.low[k] = bounds[0];
    head.high[k] = bounds[1];
    if (!(bounds[0] < bounds[1])) dump.refuse("a box without room");
  }
  dump.expect("ITEM: " + what);
  return head;
}

/// A whole number in [low, high].
std::int64_t whole(double x, std::int64_t low, std::int64_t high, const Dump& dump) {
  if (x != std::floor(x) || x < static_cast<double>(low) || x > static_cast<double>(high))
    dump.refuse(fmt::format("{} is not among {} to {}", x, low, high));
  return static_cast<std::int64_t>(x);
}

DumpedContact read_contact(const std::vector<double>& row, std::int32_t bodies, const Dump& dump) {
  if (row.size() != 9) dump.refuse(fmt::format("{} numbers, 9 expected", row.size()));
  DumpedContact c;
  c.i = static_cast<std::int32_t>(whole(row[0], 1, bodies, dump) - 1);
  const std::int64_t j = whole(row[1], -6, bodies, dump);
  if (j == 0) dump.refuse("a contact with body 0");
  c.j = static_cast<std::int32_t>(j > 0 ? j - 1 : bodies - j - 1);
  c.normal_force = row[2];
  c.force = {{row[3], row[4], row[5]}};
  c.branch = {{row[6], row[7], row[8]}};
  if (c.i < c.j) return c;
  std::swap(c.i, c.j);
  c.force = -c.force;
  c.branch = -c.branch;
  return c;
}

constexpr std::uintmax_t kTail = 65536;
constexpr std::size_t kLastLines = 4;

}  // namespace

DumpedBodies read_bodies(const std::string& path, const MacroPacking& packing) {
  Dump dump(path);
  const DumpHead head = read_head(dump, "ATOMS");
  const std::size_t n = packing.bodies.size();
  if (head.entries != static_cast<double>(n))
    throw IoError(fmt::format("{}: {} bodies, the scene has {}", path, head.entries, n));
  DumpedBodies out{head.low, head.high, std::vector<Vec3>(n)};
  std::vector<double> row;
  for (std::size_t k = 0; k < n; ++k) {
    dump.numbers(row);
    if (row.size() != 6 || row[0] != static_cast<double>(k + 1)) dump.refuse("not the body that comes next");
    if (std::abs(row[2] - packing.bodies[k].r) > 1e-12 * packing.bodies[k].r)
      dump.refuse("not the radius of this body");
    out.x[k] = {{row[3], row[4], row[5]}};
  }
  return out;
}

std::vector<DumpedContact> read_contacts(const std::string& path, std::int32_t bodies, double count, double force_sum) {
  Dump dump(path);
  const DumpHead head = read_head(dump, "ENTRIES");
  if (head.entries != count)
    throw IoError(fmt::format("{}: {} contacts, the last point has {}", path, head.entries, count));
  std::vector<DumpedContact> out;
  std::vector<double> row;
  double sum = 0.0;
  for (double k = 0.0; k < count; k += 1.0) {
    dump.numbers(row);
    out.push_back(read_contact(row, bodies, dump));
    sum += std::abs(out.back().normal_force);
  }
  if (std::abs(sum - force_sum) > 1e-9 * force_sum)
    throw IoError(fmt::format("{}: forces sum up to {} N, the last point has {}", path, sum, force_sum));
  const auto key = [](const DumpedContact& c) { return std::pair(c.i, c.j); };
  std::sort(out.begin(), out.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  return out;
}

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
