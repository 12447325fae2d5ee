#include "common/io/csv_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/text_file.h"

namespace softgrain {

namespace csv {

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string unquoted(const std::string& text) {
  const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  return quoted ? trimmed(text.substr(1, text.size() - 2)) : text;
}

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

namespace {

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

}  // namespace

std::string plain_name(const std::string& name) {
  std::string text = lower(name);
  for (const auto& [from, to] : {std::pair{"\u2019", ""},
                                 {"'", ""},
                                 {"_", " "},
                                 {"-", " "},
                                 {"\t", " "},
                                 {"µ", "mu"},
                                 {"μ", "mu"},
                                 {"ν", "nu"},
                                 {"ρ", "rho"},
                                 {".", " "}})
    replace_all(text, from, to);
  replace_all(text, "  ", " ");
  return trimmed(text);
}

}  // namespace csv

namespace {

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

/// What a spreadsheet writes into a cell that it could not compute.
bool is_spreadsheet_error(const std::string& cell) {
  constexpr std::array kErrors{"#n/a", "#div/0!", "#ref!", "#value!", "#num!", "#name?", "#null!"};
  return std::ranges::find(kErrors, csv::lower(cell)) != kErrors.end();
}

/// The same where a quote within a cell is a character of it: a sieve of 3/8".
std::vector<std::string> split_with_inches(const std::string& line, char separator) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const char c = line[k];
    if (c == separator && !quoted)
      cells.emplace_back();
    else if (c == '"' && quoted && k + 1 < line.size() && line[k + 1] == '"')
      cells.back() += line[k++];
    else if (c == '"' && (quoted || trimmed(cells.back()).empty()))
      quoted = !quoted;
    else
      cells.back() += c;
  }
  for (std::string& cell : cells) cell = trimmed(cell);
  return cells;
}

/// What looks like a blank or a minus sign in a spreadsheet and is another character.
std::string plain_signs(std::string text) {
  for (const char* blank : {"\u00a0", "\u2009", "\u202f"}) csv::replace_all(text, blank, " ");
  csv::replace_all(text, "\u2212", "-");
  return text;
}

/// The separator of a line "sep=;" that spreadsheets read; 0: it is none.
char said_separator(const std::string& line) {
  const std::string words = csv::unquoted(trimmed(line));
  if (!csv::lower(words).starts_with("sep=") || words.size() > 5) return 0;
  return words.size() == 4 ? '\t' : words[4];
}

}  // namespace

bool csv::is_missing(const std::string& cell) {
  constexpr std::array kMissing{"", "-", "nan", "na", "n/a"};
  return std::ranges::find(kMissing, csv::lower(cell)) != kMissing.end() || is_spreadsheet_error(cell);
}

bool is_percent(const std::string& unit) { return unit == "%" || csv::lower(unit) == "percent"; }

CsvFile CsvFile::read(const std::string& path) { return parse(read_text(path), path); }

CsvFile CsvFile::parse(const std::string& bytes, const std::string& path, const std::string& header) {
  CsvFile file;
  file.path_ = path;
  file.example_ = header;
  file.read_lines(bytes);
  if (file.columns_.empty())
    throw InputError(path + ":1: no header: the first line that is no comment names columns and units, e.g. " + header);
  return file;
}

std::optional<CsvFile> CsvFile::find(const std::string& bytes, const std::string& path, const CsvIsHeader& is_header,
                                     const CsvIsValue& is_value) {
  CsvFile file;
  file.path_ = path;
  file.is_header_ = is_header;
  file.read_lines(bytes);
  if (file.columns_.empty()) return std::nullopt;
  file.refuse_rows_above(is_value);
  return file;
}

void CsvFile::read_lines(const std::string& bytes) {
  const std::string text = plain_signs(utf8_of(bytes));
  if (text.find('\0') != std::string::npos)
    throw InputError(path_ + ": is a binary file, not a table: save it as text (CSV), from a spreadsheet for instance");
  int number = 1;
  for (std::size_t at = 0; at < text.size(); ++number) {
    const std::size_t end = std::min(text.find_first_of("\r\n", at), text.size());
    read_line(text.substr(at, end - at), number);
    const bool pair = end + 1 < text.size() && text[end] == '\r' && text[end + 1] == '\n';
    at = end + (pair ? 2 : 1);
  }
}

void CsvFile::read_line(const std::string& line, int number) {
  const std::string words = trimmed(line);
  if (words.find_first_not_of(";, \t\"\x1a") == std::string::npos) return;
  if (words.front() == '#' && !names_a_sieve(words) &&
      (columns_.empty() || !is_spreadsheet_error(split(words, separator_).front())))
    return read_comment(words, number);
  if (words.starts_with("\"#")) {  // a spreadsheet quotes cells that hold the separator
    const std::size_t end = words.find('"', 1);
    return read_comment(words.substr(1, end == std::string::npos ? end : end - 1), number);
  }
  if (!columns_.empty()) return read_row(line, number);
  const char said = said_separator(line);
  if (said == 0) return is_header_ ? find_header(words, number) : read_header(words, number);
  separator_ = said;
  separator_said_ = true;
}

void CsvFile::read_header(const std::string& line, int number) {
  if (!separator_said_)
    for (const char c : {',', '\t', ';'})
      if (line.find(c) != std::string::npos) separator_ = c;
  header_line_ = number;
  std::vector<std::string> titles = split(line, separator_);
  while (titles.size() > 1 && titles.back().empty()) titles.pop_back();
  for (const std::string& title : titles) {
    if (title.empty()) throw InputError(where(number) + ": header: a column has no name");
    columns_.push_back(csv::column_of(title));
    const std::string& name = columns_.back().name;
    if (!name.empty() && name.find_first_not_of("0123456789.+-e") == std::string::npos)
      throw InputError(where(number) + ": no header: \"" + title +
                       "\" is a number; the first line that is no comment names columns and units, e.g. " + example_);
    for (std::size_t k = 0; k + 1 < columns_.size(); ++k)
      if (columns_[k].name == name)
        throw InputError(where(number) + ": header: column \"" + title + "\" is there twice");
  }
}

/// "#200; 12.5" is no comment below the header of a laboratory.
bool CsvFile::names_a_sieve(const std::string& line) const {
  if (!is_header_ || columns_.empty() || line.find(separator_) == std::string::npos) return false;
  const std::string number = trimmed(line.substr(1, line.find(separator_) - 1));
  return !number.empty() && number.find_first_not_of("0123456789") == std::string::npos;
}

void CsvFile::find_header(const std::string& line, int number) {
  for (const char c : {';', '\t', ','}) {
    if (separator_said_ ? c != separator_ : line.find(c) == std::string::npos) continue;
    std::vector<std::string> titles = split_with_inches(line, c);
    while (titles.size() > 1 && titles.back().empty()) titles.pop_back();
    std::vector<CsvColumn> columns;
    for (const std::string& title : titles) columns.push_back(csv::column_of(title));
    if (!is_header_(columns)) continue;
    separator_ = c;
    header_line_ = number;
    columns_ = std::move(columns);
    return;
  }
  above_.emplace_back(number, line);
}

/// Rows that were put above their header would else be taken for titles and be missing.
void CsvFile::refuse_rows_above(const CsvIsValue& is_value) const {
  const auto is_number = [](std::string cell) {
    const auto is_mark = [](char c) { return c == '.' || c == ','; };
    if (cell.ends_with('%')) cell = trimmed(cell.substr(0, cell.size() - 1));
    if (cell.starts_with('-')) cell.erase(0, 1);
    return !cell.empty() && cell.find_first_not_of("0123456789.,") == std::string::npos && !is_mark(cell.front()) &&
           std::ranges::count_if(cell, is_mark) <= 1;  // a date has two
  };
  const auto belongs = [&](const std::string& cell) { return is_number(cell) || is_value(cell); };
  for (const auto& [number, line] : above_) {
    std::vector<std::string> cells = split_with_inches(line, separator_);
    std::erase(cells, "");
    if (cells.size() > 1 && std::ranges::all_of(cells, belongs))
      throw InputError(where(number) + ": a row of the table above the header (line " + std::to_string(header_line_) +
                       "): put it below, or \"#\" before it");
  }
}

bool CsvFile::read_more_titles(const std::string& line, int number) {
  const std::vector<std::string> cells = split_with_inches(line, separator_);
  if (!rows_.empty() || number != header_line_ + 1 || cells.size() < columns_.size() ||
      line.find_first_of("0123456789") != std::string::npos)
    return false;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    if (cells[k].empty()) continue;
    const bool bracket = cells[k].find_first_of("[( ") != std::string::npos;
    columns_[k] = csv::column_of(columns_[k].title + (bracket ? " " + cells[k] : " [" + cells[k] + "]"));
  }
  return true;
}

void CsvFile::read_row(const std::string& line, int number) {
  if (is_header_ && read_more_titles(line, number)) return;
  CsvRow row{is_header_ ? split_with_inches(line, separator_) : split(line, separator_), number};
  if (is_header_) {
    const std::string& first = row.cells.front();
    const bool text = !first.empty() && first.find_first_of("0123456789") == std::string::npos;  // below the table
    const std::size_t known = std::min(columns_.size(), row.cells.size());
    const bool words =
        std::all_of(row.cells.begin() + static_cast<std::ptrdiff_t>(known), row.cells.end(),
                    [](const std::string& c) { return c.find_first_of("0123456789") == std::string::npos; });
    row.cells.resize(text && words ? columns_.size() : std::max(row.cells.size(), columns_.size()));
  }
  while (row.cells.size() > columns_.size() && row.cells.back().empty()) row.cells.pop_back();
  if (row.cells.size() != columns_.size())
    throw InputError(where(number) + ": " + counted(row.cells.size(), "cell") + ", the header (line " +
                     std::to_string(header_line_) + ") has " + counted(columns_.size(), "column") +
                     (separator_ == ',' && row.cells.size() > columns_.size()
                          ? "; where numbers have decimal commas, separate columns by ; or tab"
                          : ""));
  note_marks(row);
  rows_.push_back(std::move(row));
}

void CsvFile::note_marks(const CsvRow& row) {
  if (separator_ == ',') return;
  marks_.resize(columns_.size());
  for (std::size_t k = 0; k < row.cells.size(); ++k) {
    const auto is_new = [&](char mark, bool known) { return !known && row.cells[k].find(mark) != std::string::npos; };
    if (!is_new(',', marks_[k].comma) && !is_new('.', marks_[k].point)) continue;
    const csv::DecimalMarks own = csv::decimal_marks({row.cells[k]}, separator_);
    marks_[k].comma = marks_[k].comma || own.comma;
    marks_[k].point = marks_[k].point || own.point;
  }
}

bool CsvFile::has_decimal_commas() const { return std::ranges::any_of(marks_, &csv::DecimalMarks::comma); }

/// "1.250" in a column that shows decimal commas may be 1250, and "1,250" in one that shows points. Which, nobody says.
/// So may "1.250" in a column that shows neither, of a table with decimal commas: forces "800" and "1.250" beside
/// "0,5". Between tabs "1,250" may be either where no column shows a decimal comma.
void CsvFile::refuse_thousands(const CsvRow& row, std::size_t column) const {
  const std::string& cell = row.cells[column];
  const std::size_t at = cell.find_first_of(".,");
  if (at == std::string::npos) return;
  const csv::DecimalMarks own = csv::decimal_marks({cell}, separator_);
  if (own.comma || own.point) return;
  const std::string place = where(row.line) + ": column \"" + columns_[column].title + "\": ";
  const csv::DecimalMarks& shown = marks_[column];
  if (cell[at] == ',' ? shown.point : shown.comma || (!shown.point && has_decimal_commas()))
    throw InputError(place + "\"" + cell +
                     "\" may have a sign between thousands, as other numbers have another decimal mark: write numbers "
                     "with one mark, e.g. 1234.5");
  if (cell[at] == ',' && separator_ == '\t' && !has_decimal_commas()) throw InputError(place + csv::two_readings(cell));
}

void CsvFile::require_known_columns(const CsvNames& known, const std::string& what) const {
  const CsvNames labels{"id",      "no",       "nr",     "index",   "name", "label",
                        "comment", "comments", "remark", "remarks", "note", "notes"};
  for (const CsvColumn& c : columns_) {
    const auto is_in = [&](const CsvNames& names) { return std::ranges::find(names, c.name) != names.end(); };
    if (is_in(known) || is_in(labels)) continue;
    const std::string near = nearest_word(c.name, known);
    throw InputError(where(header_line_) + ": column \"" + c.title + "\" is not understood" +
                     (near.empty() ? "" : "; nearest is \"" + near + "\"") + ": columns of " + what + " are " +
                     join_text(known) + "; remove it, or rename it \"comment\"");
  }
}

namespace {

bool is_unit_of(const std::string& text, Unit unit) {
  try {
    (void)parse_quantity("1 " + text, unit);
    return !text.empty();
  } catch (const InputError&) {
    return false;
  }
}

/// "displacement in ", "f /" without what stands between a name and its unit.
std::string name_before_unit(std::string name) {
  constexpr const char* kBetween = " _/,";
  const auto without_end = [&] { name.resize(name.find_last_not_of(kBetween) + 1); };
  without_end();
  for (const char* in : {" in", "_in"})
    if (name.ends_with(in)) {
      name.resize(name.size() - 3);
      without_end();
    }
  return name;
}

}  // namespace

void CsvFile::take_units_behind_names(const std::function<std::optional<Unit>(const std::string&)>& unit_of) {
  for (CsvColumn& c : columns_) {
    if (!c.unit.empty() || unit_of(c.name)) continue;
    for (std::size_t at = c.title.find_first_of(" _/"); at != std::string::npos;
         at = c.title.find_first_of(" _/", at + 1)) {
      const std::string name = name_before_unit(csv::lower(c.title.substr(0, at)));
      const std::string unit = trimmed(c.title.substr(at + 1));
      const std::optional<Unit> quantity = unit_of(name);
      if (!quantity || *quantity == Unit::none || !is_unit_of(unit, *quantity)) continue;
      c.name = name;
      c.unit = unit;
      break;
    }
  }
}

std::optional<double> CsvFile::number(const CsvRow& row, std::size_t column, Unit unit) const {
  std::string cell = row.cells[column];
  if (csv::is_missing(cell)) return std::nullopt;
  if (cell.find(',') != std::string::npos && cell.find('.') != std::string::npos)
    throw InputError(where(row.line) + ": column \"" + columns_[column].title + "\": \"" + cell +
                     "\" has a comma and a point: write numbers without a sign between thousands, e.g. 1234.5");
  if (separator_ != ',') {
    refuse_thousands(row, column);
    std::replace(cell.begin(), cell.end(), ',', '.');
  }
  const CsvColumn& c = columns_[column];
  const bool percent_sign = unit == Unit::none && cell.back() == '%';
  if (percent_sign) cell = trimmed(cell.substr(0, cell.size() - 1));
  const double part = percent_sign || (unit == Unit::none && is_percent(c.unit)) ? 100.0 : 1.0;
  const bool own_unit =
      cell.find(' ') != std::string::npos ||
      (!cell.empty() && cell.back() != '.' && std::isdigit(static_cast<unsigned char>(cell.back())) == 0);
  const bool pure = unit == Unit::none || c.unit.empty();
  try {
    return parse_quantity(own_unit || pure ? cell : cell + " " + c.unit, unit) / part;
  } catch (const InputError& e) {
    throw InputError(where(row.line) + ": column \"" + c.title + "\": \"" + row.cells[column] + "\" " + e.what());
  }
}

void CsvFile::require_unit(std::size_t column, Unit unit, const char* example) const {
  const CsvColumn& c = columns_[column];
  const auto complain = [&](const std::string& problem) {
    throw InputError(where(header_line_) + ": column \"" + c.title + "\": " + problem);
  };
  if (unit == Unit::none) {
    if (!c.unit.empty() && c.unit != "1" && c.unit != "-" && !is_percent(c.unit))
      complain("it has no unit, \"" + c.unit + "\" is given");
    return;
  }
  if (c.unit.empty()) complain(std::string("no unit; write it behind the name, e.g. ") + example);
  try {
    (void)parse_quantity("1 " + c.unit, unit);
  } catch (const InputError& e) {
    complain(e.what());
  }
}

}  // namespace softgrain
