#include "common/io/csv_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "common/core/error.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace {

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Cells of a line; a separator within double quotes is text.
std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == separator && !quoted)
      cells.emplace_back();
    else
      cells.back() += c;
  }
  for (std::string& cell : cells) cell = trimmed(cell);
  return cells;
}

bool is_missing(const std::string& cell) {
  constexpr std::array kMissing{"", "-", "nan", "na", "n/a"};
  return std::find(kMissing.begin(), kMissing.end(), lower(cell)) != kMissing.end();
}

/// "hn [mm]" or "hn (mm)" into its parts.
CsvColumn column_of(const std::string& title) {
  CsvColumn column{title, lower(title), ""};
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const std::size_t at = title.find(open);
    if (at == std::string::npos || title.back() != close) continue;
    column.name = lower(trimmed(title.substr(0, at)));
    column.unit = trimmed(title.substr(at + 1, title.size() - at - 2));
    break;
  }
  return column;
}

}  // namespace

CsvFile CsvFile::read(const std::string& path) { return parse(read_text(path), path); }

CsvFile CsvFile::parse(const std::string& text, const std::string& path) {
  CsvFile file;
  file.path_ = path;
  std::size_t at = text.starts_with("\xef\xbb\xbf") ? 3 : 0;  // spreadsheets mark UTF-8 with these
  for (int number = 1; at < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    const std::string words = trimmed(line);
    at = end + 1;
    if (words.empty()) continue;
    if (words.front() == '#')
      file.read_comment(words, number);
    else if (file.columns_.empty())
      file.read_header(words, number);
    else
      file.read_row(line, number);
  }
  if (file.columns_.empty())
    throw BadInput(path +
                   ":1: no header: the first line that is no comment names columns and units, e.g. hn [mm], Fn [N]");
  return file;
}

void CsvFile::read_comment(const std::string& line, int number) {
  const std::string words = trimmed(line.substr(std::min(line.find_first_not_of('#'), line.size())));
  const std::size_t mark = words.find_first_of("=:");
  if (mark == std::string::npos) return;
  std::string value = trimmed(words.substr(mark + 1));
  if (value.size() >= 2 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
  settings_.push_back({lower(trimmed(words.substr(0, mark))), value, number});
}

void CsvFile::read_header(const std::string& line, int number) {
  for (const char c : {',', '\t', ';'})
    if (line.find(c) != std::string::npos) separator_ = c;
  header_line_ = number;
  for (const std::string& title : split(line, separator_)) {
    if (title.empty()) throw BadInput(where(number) + ": header: a column has no name");
    columns_.push_back(column_of(title));
    const std::string& name = columns_.back().name;
    if (!name.empty() && name.find_first_not_of("0123456789.+-e") == std::string::npos)
      throw BadInput(where(number) + ": no header: \"" + title +
                     "\" is a number; the first line that is no comment names columns and units, e.g. hn [mm], Fn [N]");
    for (std::size_t k = 0; k + 1 < columns_.size(); ++k)
      if (columns_[k].name == name) throw BadInput(where(number) + ": header: column \"" + title + "\" is there twice");
  }
}

void CsvFile::read_row(const std::string& line, int number) {
  CsvRow row{split(line, separator_), number};
  while (row.cells.size() > columns_.size() && row.cells.back().empty()) row.cells.pop_back();
  if (row.cells.size() != columns_.size())
    throw BadInput(where(number) + ": " + std::to_string(row.cells.size()) + " cells, the header (line " +
                   std::to_string(header_line_) + ") has " + std::to_string(columns_.size()) + " columns");
  rows_.push_back(std::move(row));
}

std::optional<CsvSetting> CsvFile::setting(const std::vector<std::string>& keys) const {
  std::optional<CsvSetting> found;
  for (const CsvSetting& s : settings_)
    if (std::find(keys.begin(), keys.end(), s.key) != keys.end()) found = s;
  return found;
}

std::optional<double> CsvFile::number(const CsvRow& row, std::size_t column, Unit unit) const {
  std::string cell = row.cells[column];
  if (is_missing(cell)) return std::nullopt;
  if (separator_ != ',') std::replace(cell.begin(), cell.end(), ',', '.');
  const CsvColumn& c = columns_[column];
  const bool own_unit = cell.find(' ') != std::string::npos;
  const bool pure = unit == Unit::none || c.unit.empty();
  try {
    return parse_quantity(own_unit || pure ? cell : cell + " " + c.unit, unit);
  } catch (const BadInput& e) {
    throw BadInput(where(row.line) + ": column \"" + c.title + "\": \"" + row.cells[column] + "\" " + e.what());
  }
}

void CsvFile::require_unit(std::size_t column, Unit unit, const char* example) const {
  const CsvColumn& c = columns_[column];
  const auto complain = [&](const std::string& problem) {
    throw BadInput(where(header_line_) + ": column \"" + c.title + "\": " + problem);
  };
  if (unit == Unit::none) {
    if (!c.unit.empty() && c.unit != "1" && c.unit != "-") complain("it has no unit, \"" + c.unit + "\" is given");
    return;
  }
  if (c.unit.empty()) complain(std::string("no unit; write it behind the name, e.g. ") + example);
  try {
    (void)parse_quantity("1 " + c.unit, unit);
  } catch (const BadInput& e) {
    complain(e.what());
  }
}

}  // namespace softgrain
