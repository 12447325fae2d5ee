#include "macrosim/lammps_run/points_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include "common/core/error.h"
#include "common/io/text_file.h"
#include "macrosim/body_contacts.h"
#include "macrosim/lammps_run/input_script.h"

namespace softgrain::lammps {

namespace {

std::string head_line(const std::string& key, bool earlier = false) {
  return fmt::format("{}, scene {}", earlier ? kEarlierPointsHead : kPointsHead, key);
}

/// Columns that every test has.
std::size_t columns_of(bool earlier) { return earlier ? kEarlierColumns : kPointColumns.size(); }

/// Lines that end with a newline: what follows the last one was cut short.
std::vector<std::string> whole_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', begin)) {
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

std::vector<std::string> lines_of(const std::string& path) {
  return std::filesystem::exists(path) ? whole_lines(read_text(path)) : std::vector<std::string>{};
}

PointRow parse(const std::string& line, const std::string& where, std::size_t more, bool earlier) {
  const std::size_t columns = columns_of(earlier);
  PointRow row;
  row.earlier = earlier;
  std::istringstream words(line);
  std::string word;
  std::size_t k = 0;
  while (words >> word) {
    double x = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
    if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(x))
      throw IoError(where + ": '" + word + "' is no finite number");
    if (k < columns)
      row.values[k] = x;
    else
      row.more.push_back(x);
    ++k;
  }
  if (k != columns + more) throw IoError(fmt::format("{}: {} numbers, {} expected", where, k, columns + more));
  if (!earlier) return row;
  for (const auto& [here, there] : {std::pair{Point::unrest, Point::residual}, {Point::unrest_end, Point::end}})
    row.values[static_cast<std::size_t>(here)] = row[there];
  return row;
}

/// Takes a row in, in the place of one of the same number.
void take(const PointRow& row, const std::string& where, std::vector<PointRow>& rows) {
  const double number = row[Point::number];
  if (!(number >= 0.0) || number != std::floor(number) || number > static_cast<double>(rows.size()))
    throw IoError(fmt::format("{}: point {} follows {} points", where, number, rows.size()));
  rows.resize(static_cast<std::size_t>(number));
  rows.push_back(row);
}

/// The first of compute softgrain/contacts that grains are told of.
constexpr int kFirstValue = 18;

constexpr Bearers kBearers[] = {Bearers::coarse_coarse, Bearers::coarse_fine, Bearers::fine_fine};

}  // namespace

std::vector<PointRow> read_points(const std::string& directory, const std::string& key,
                                  const std::vector<std::string>& more) {
  const std::string path = directory + "/" + kPointsFile;
  const auto lines = lines_of(path);
  const auto copy = lines_of(directory + "/" + kPointsCopy);
  if (lines.empty()) return {};
  const bool earlier = lines[0].starts_with(kEarlierPointsHead);
  if (!earlier && !lines[0].starts_with(kPointsHead)) throw IoError(path + ": not a table of points of softgrain");
  if (lines[0] != head_line(key, earlier))
    throw InputError(path + ": belongs to another scene, seed or law than this run");
  const std::size_t both = std::min(lines.size(), copy.size());
  if (lines.size() > copy.size() + 1 || copy.size() > lines.size() + 1)
    throw IoError(fmt::format("{}: has {} lines, its copy {} has {}: one of them is damaged", path, lines.size(),
                              kPointsCopy, copy.size()));
  std::vector<PointRow> rows;
  for (std::size_t k = 0; k < both; ++k) {
    const std::string where = fmt::format("{}, line {}", path, k + 1);
    if (lines[k] != copy[k])
      throw IoError(fmt::format("{}: differs from its copy {}: one of them is damaged", where, kPointsCopy));
    if (!lines[k].starts_with('#')) take(parse(lines[k], where, more.size(), earlier), where, rows);
  }
  return rows;
}

void write_points(const std::string& directory, const std::string& key, const std::vector<PointRow>& rows,
                  const std::vector<std::string>& more) {
  const bool earlier = !rows.empty() && rows.front().earlier;  // its script is there too, and goes on writing such rows
  const std::size_t columns = columns_of(earlier);
  std::string text = head_line(key, earlier) + "\n#";
  for (std::size_t k = 0; k < columns; ++k) text += std::string(" ") + kPointColumns[k].name;
  for (const std::string& name : more) text += " " + name;
  text += "\n";
  for (const PointRow& row : rows) {
    text += fmt::format("{}", row.values[0]);
    for (std::size_t k = 1; k < columns; ++k) text += fmt::format(" {}", row.values[k]);
    for (const double x : row.more) text += fmt::format(" {}", x);
    text += "\n";
  }
  write_text_atomic(directory + "/" + kPointsCopy, text);
  write_text_atomic(directory + "/" + kPointsFile, text);
}

std::int64_t count_points(const std::string& directory) {
  std::ifstream in(directory + "/" + kPointsFile);
  std::set<std::string> numbers;
  std::string line;
  while (std::getline(in, line))
    if (!line.empty() && line[0] >= '0' && line[0] <= '9') numbers.insert(line.substr(0, line.find(' ')));
  return static_cast<std::int64_t>(numbers.size());
}

std::string grain_words(const MacroSpec& spec, const MacroPacking& packing) {
  if (spec.splits.empty()) return "";
  double largest = 0.0;
  for (const MacroBody& b : packing.bodies) largest = std::max(largest, b.r);
  std::string text = fmt::format(" grains {}", contacts_that_hold(spec));
  for (const double split : spec.splits) text += fmt::format(" {}", split * largest);
  return text;
}

std::vector<GrainColumn> grain_columns(const MacroSpec& spec) {
  std::vector<GrainColumn> columns;
  const auto add = [&](const std::string& name) {
    columns.push_back({name, fmt::format("c_contacts[{}]", kFirstValue + static_cast<int>(columns.size()))});
  };
  if (!spec.splits.empty()) add(kRattlers);
  for (const double split : spec.splits)
    for (const Bearers b : kBearers) add(fmt::format("{}_{:.4g}", to_string(b), split));
  return columns;
}

std::vector<std::string> grain_names(const MacroSpec& spec) {
  std::vector<std::string> names;
  for (const GrainColumn& c : grain_columns(spec)) names.push_back(c.name);
  return names;
}

void add_grains(const PointRow& row, const MacroSpec& spec, const MacroPacking& packing, MacroCurve& curve) {
  if (spec.splits.empty()) return;
  const double volume = row[Point::lx] * row[Point::ly] * row[Point::lz];
  const double virial = row[Point::branch_xx] + row[Point::branch_yy] + row[Point::branch_zz];
  curve.more[kSolidFraction].push_back(packing.body_volume() / volume);
  curve.more[kRattlers].push_back(row.more[0] / static_cast<double>(packing.bodies.size()));
  std::size_t k = 1;
  for (const double split : spec.splits)
    for (const Bearers b : kBearers) {
      const double of_these = row.more[k++];
      curve.more[share_name(b, split)].push_back(virial > 0.0 ? of_these / virial : 0.0);
    }
}

}  // namespace softgrain::lammps
