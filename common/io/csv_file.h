// Tables of measurements as text: a header that names columns and units, comments with "#", columns separated by
// comma, semicolon or tab. Everything that is wrong is said with file and line.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/io/scene.h"

namespace softgrain {

/// "hn [mm]": name in lower case, unit as written (empty: none).
struct CsvColumn {
  std::string title;  ///< as in the header
  std::string name;
  std::string unit;
};

/// A comment of the form "# E = 0.5 MPa" ("# E: 0.5 MPa").
struct CsvSetting {
  std::string key;  ///< in lower case
  std::string value;
  int line = 0;
};

struct CsvRow {
  std::vector<std::string> cells;  ///< one per column, without spaces around
  int line = 0;
};

class CsvFile {
 public:
  /// The separator is the first of ";", tab, "," that the header has. With another one than the comma, a comma in a
  /// number is its decimal mark. Cells may stand in double quotes. Throws BadInput (no header, a row of another
  /// length), FileTrouble.
  static CsvFile read(const std::string& path);
  /// The same from a text.
  static CsvFile parse(const std::string& text, const std::string& path);

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::vector<CsvColumn>& columns() const { return columns_; }
  [[nodiscard]] const std::vector<CsvRow>& rows() const { return rows_; }
  [[nodiscard]] int header_line() const { return header_line_; }
  /// The last comment with one of these keys (lower case).
  [[nodiscard]] std::optional<CsvSetting> setting(const std::vector<std::string>& keys) const;
  /// "file:line".
  [[nodiscard]] std::string where(int line) const { return path_ + ":" + std::to_string(line); }

  /// SI value of a cell in the unit of its column; a number with a unit of its own is fine too. Empty cells, "-", "nan"
  /// and "NA" give nothing. Throws BadInput naming line and column.
  [[nodiscard]] std::optional<double> number(const CsvRow& row, std::size_t column, Unit unit) const;

  /// Throws BadInput at the header unless the unit of the column is one of `unit` (Unit::none: none, "1" or "-").
  void require_unit(std::size_t column, Unit unit, const char* example) const;

 private:
  void read_header(const std::string& line, int number);
  void read_row(const std::string& line, int number);
  void read_comment(const std::string& line, int number);

  std::string path_;
  char separator_ = ',';
  int header_line_ = 0;
  std::vector<CsvColumn> columns_;
  std::vector<CsvRow> rows_;
  std::vector<CsvSetting> settings_;
};

}  // namespace softgrain
