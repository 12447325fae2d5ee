// Tables of measurements as text: a header that names columns and units, comments with "#", columns separated by
// comma, semicolon or tab. Everything that is wrong is said with file and line.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/io/scene.h"

namespace softgrain {

/// "hn [mm]": name in lower case, unit as written (empty: none).
struct CsvColumn {
  std::string title;  ///< column title as in the header
  std::string name;
  std::string unit;
};

/// A comment that names a value: "# E = 0.5 MPa", "# E: 0.5 MPa", "# E [MPa] = 0.5", "# E(MPa): 0.5", "# E 0.5 MPa".
struct CsvSetting {
  std::string title;  ///< the name as written, with its unit
  std::string key;    ///< the name in lower case, without unit and apostrophes, its words apart by one blank
  std::string unit;   ///< behind the name, as written; empty: none
  std::string value;
  bool equals = true;  ///< an equals sign stands between them, not a colon
  bool bare = false;   ///< neither does: "# Rs 16 mm"
  int line = 0;
};

struct CsvRow {
  std::vector<std::string> cells;  ///< one per column, without spaces around
  int line = 0;
};

/// Names of one quantity, as CsvSetting::key has them.
using CsvNames = std::vector<std::string>;

/// Tells the line of the header from lines of text above it.
using CsvIsHeader = std::function<bool(const std::vector<CsvColumn>&)>;

/// Tells cells of a row that are more than a number ("No. 4", "150 g") from words of a title.
using CsvIsValue = std::function<bool(const std::string&)>;

namespace csv {

/// Which decimal marks the numbers of a column show. A mark with three digits behind it may separate thousands.
struct DecimalMarks {
  bool comma = false;
  bool point = false;
  bool comma_may_separate_thousands = false;  ///< not where ";" separates cells: there commas are decimal marks
};

}  // namespace csv

class CsvFile {
 public:
  /// Reads a file in any encoding that utf8_of() knows, with any line ends. The separator is what a first line "sep=;"
  /// says, else the first of ";", tab, "," that the header has. With another separator than the comma, a comma in a
  /// number is its decimal mark; with tabs, "1,016" is refused unless another cell has a decimal comma for certain.
  /// Cells may stand in double quotes. Empty cells at the end of a line and empty lines count for nothing. Throws
  /// InputError (no header, a row of another length), IoError.
  static CsvFile read(const std::string& path);
  /// Reads a table from a text in the same way; `path` stands for the file in messages, `header` for what its first
  /// line may look like.
  static CsvFile parse(const std::string& bytes, const std::string& path,
                       const std::string& header = "hn [mm], Fn [N]");
  /// Reads a table as laboratories write it; none when no line is a header. Lines above the header are titles; a line
  /// of words right below it goes on with the titles of the columns ("mm; g; %"); columns may have no title, or one
  /// that is there twice; rows may be short. A double quote within a cell is a character (3/8"). Throws InputError for
  /// a row that is too long or above the header: two or more cells there, all numbers or values.
  static std::optional<CsvFile> find(const std::string& bytes, const std::string& path, const CsvIsHeader& is_header,
                                     const CsvIsValue& is_value);

  /// Takes units apart that stand behind a name without brackets: "force_N", "Force N", "F/N", "displacement_in_mm".
  /// `unit_of` says which quantity a name has, nothing for an unknown one. Names that it knows as they are stay
  /// ("F_n").
  void take_units_behind_names(const std::function<std::optional<Unit>(const std::string&)>& unit_of);

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::vector<CsvColumn>& columns() const { return columns_; }
  [[nodiscard]] const std::vector<CsvRow>& rows() const { return rows_; }
  [[nodiscard]] int header_line() const { return header_line_; }
  [[nodiscard]] char separator() const { return separator_; }
  /// Whether a table with ";" or tabs has a decimal comma for certain ("0,5"): then "1,016" is 1.016 in it too, and
  /// "1.250" may be 1250.
  [[nodiscard]] bool has_decimal_commas() const;
  /// "file:line".
  [[nodiscard]] std::string where(int line) const { return path_ + ":" + std::to_string(line); }

  /// The first comment with one of these names.
  [[nodiscard]] std::optional<CsvSetting> setting(const CsvNames& names) const;
  /// The first comment with one of these names, as a word. Throws InputError where several comments say different
  /// words.
  [[nodiscard]] std::optional<CsvSetting> word(const CsvNames& names) const;
  /// SI value of the comment with one of these names. Throws InputError for what is no such number or out of range, and
  /// where several comments contradict each other.
  [[nodiscard]] std::optional<double> quantity(const CsvNames& names, Unit unit, const Range& range) const;
  /// SI values of the comment with one of these names: `count` numbers, separated by blanks or commas, with one unit
  /// for all. Throws InputError for what are no such numbers, and where several comments contradict each other.
  [[nodiscard]] std::optional<std::vector<double>> quantities(const CsvNames& names, Unit unit,
                                                              std::size_t count) const;
  /// Throws InputError for a comment "name [unit] = value" (or "name = value unit") with another name than the known
  /// ones: whoever wrote it expects it to count. Other comments are free text. `what` the file is, as messages say it.
  void require_known_comments(const std::vector<CsvNames>& known, const std::string& what) const;
  /// Throws InputError for a column that is not among `known` names and no label of rows (id, name, comment, ...).
  void require_known_columns(const CsvNames& known, const std::string& what) const;

  /// SI value of a cell in the unit of its column; a number with a unit of its own is fine too, and so are percents of
  /// a number without unit. Empty cells, "-", "nan" and "NA" give nothing. Throws InputError naming line and column,
  /// for numbers too whose mark may be decimal or between thousands.
  [[nodiscard]] std::optional<double> number(const CsvRow& row, std::size_t column, Unit unit) const;

  /// Throws InputError at the header unless the unit of the column is one of `unit` (Unit::none: none, "1", "-" or
  /// "%").
  void require_unit(std::size_t column, Unit unit, const char* example) const;

 private:
  void read_lines(const std::string& bytes);
  void read_line(const std::string& line, int number);
  void find_header(const std::string& line, int number);
  void refuse_rows_above(const CsvIsValue& is_value) const;
  [[nodiscard]] bool names_a_sieve(const std::string& line) const;
  bool read_more_titles(const std::string& line, int number);
  void read_header(const std::string& line, int number);
  void read_row(const std::string& line, int number);
  void read_comment(const std::string& line, int number);
  void note_marks(const CsvRow& row);
  void refuse_thousands(const CsvRow& row, std::size_t column) const;
  void read_setting(const std::string& text, int number);
  [[nodiscard]] std::vector<CsvSetting> all_of(const CsvNames& names) const;
  [[nodiscard]] std::vector<double> values_of(const CsvSetting& setting, Unit unit, std::size_t count) const;

  std::string path_;
  std::string example_;  ///< of a header, for messages
  char separator_ = ',';
  bool separator_said_ = false;
  CsvIsHeader is_header_{};  ///< of a laboratory's table
  int header_line_ = 0;
  std::vector<std::pair<int, std::string>> above_{};  ///< lines above a laboratory's header, with their numbers
  std::vector<CsvColumn> columns_;
  std::vector<CsvRow> rows_;
  std::vector<csv::DecimalMarks> marks_;  ///< of the columns, where a comma is no separator
  std::vector<CsvSetting> settings_;
};

/// A unit of hundredths.
bool is_percent(const std::string& unit);

// Small pieces of its texts, for csv_file.cpp and csv_comments.cpp.

namespace csv {

/// ASCII letters in lower case.
std::string lower(std::string text);

/// The text without double quotes around it.
std::string unquoted(const std::string& text);

/// "hn [mm]", "hn(mm)" into its parts.
CsvColumn column_of(const std::string& title);

/// Whether a cell says that there is no value: empty, "-", "nan", "NA", what a spreadsheet could not compute.
bool is_missing(const std::string& cell);

/// Lower case without accents: "Rückstand" to "rueckstand", "cumulé" to "cumule", "µm" to "um", "½" to " 1/2", "φ" to
/// "phi".
std::string folded(std::string text);

/// What to say of such a number where nothing tells the mark.
std::string two_readings(const std::string& number);
/// Marks of the numbers of these cells.
DecimalMarks decimal_marks(const std::vector<std::string>& cells, char separator);

/// The text with its numbers written with a decimal point alone: "1.250,5", "1 250,5" and "1'250.5" to "1250.5". Throws
/// InputError for a number that may mean two things.
std::string plain_numbers(const std::string& cell, const DecimalMarks& marks);

/// "Young's_modulus" to "youngs modulus", Greek letters to their names.
std::string plain_name(const std::string& name);

}  // namespace csv

}  // namespace softgrain
