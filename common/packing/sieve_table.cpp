#include "common/packing/sieve_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/core/error.h"
#include "common/core/text.h"
#include "common/io/csv_file.h"
#include "common/io/text_file.h"
#include "common/packing/sieve_columns.h"
#include "common/packing/sieve_retained.h"
#include "common/packing/sieve_size.h"

namespace softgrain {

namespace {

constexpr const char* kInScene = "in the table of sizes of the scene";

double snapped(double share) {
  for (const double end : {0.0, 1.0})
    if (std::abs(share - end) < kSieveRounding) return end;
  return share;
}

/// A line of the table before its sizes and values have units.
struct SieveLine {
  SieveSize size;
  std::string value;  ///< cell with plain numbers; empty: missing
  std::string cell;   ///< of the value, as written
  int line = 0;
};

class SieveReader {
 public:
  SieveReader(const CsvFile& csv, const SieveOptions& options)
      : csv_(csv), options_(options), choice_(choose_sieve_columns(csv, options.column)) {}

  SieveCurve read(int dimension) {
    csv_.require_known_comments({}, "a sieve curve");
    read_lines();
    unit_ = unit_of_sizes();
    const bool pan_row = gather();
    std::vector<SieveRow> rows = passes() ? passing_rows(pan_row) : retained_rows();
    add_ends(rows);
    std::ranges::stable_sort(rows, {}, &SieveRow::opening);
    const bool low = rows.empty() || rows.front().passing > 0.0;
    const bool one = rows.size() < 2 && !pan_row;
    const bool shares = passes() && data_.measure == SieveMeasure::percent && !rows.empty() &&
                        std::abs(rows.back().passing - 0.01) < 0.01 * kSieveRounding;
    Grading grading = sieve_grading(
        rows, dimension,
        one ? ""
            : fmt::format(
                  ", or give {0} = \"... mm\" {1} (softgrain check FILE --set '{0}=\"... mm\"'){2}",
                  low ? "smallest" : "largest", kInScene,
                  shares ? "; if these are shares, with 1 for all, leave percent out of the title of the column" : ""));
    return {std::move(grading), columns_text(), std::move(rows), std::move(remarks_)};
  }

 private:
  [[nodiscard]] const SieveTitle& size_title() const { return choice_.titles[choice_.size]; }
  [[nodiscard]] const SieveTitle& value_title() const { return choice_.titles[choice_.value]; }
  [[nodiscard]] const std::string& title_of(std::size_t column) const { return csv_.columns()[column].title; }
  [[nodiscard]] std::string head() const { return csv_.where(csv_.header_line()) + ": "; }
  [[nodiscard]] bool passes() const { return choice_.meaning == SieveColumn::passing; }

  /// `thousands`: whether numbers of the column may be so large; else "4.000" beside "0,5" of another column is 4.
  [[nodiscard]] csv::DecimalMarks marks_of(std::size_t column, bool thousands) const {
    std::vector<std::string> cells;
    for (const CsvRow& row : csv_.rows()) cells.push_back(row.cells[column]);
    csv::DecimalMarks marks = csv::decimal_marks(cells, csv_.separator());
    if (marks.comma || !csv_.has_decimal_commas()) return marks;
    marks.comma = true;
    marks.point = marks.point || !thousands;
    return marks;
  }

  /// Sieves of metres are none.
  [[nodiscard]] bool may_have_thousands_of_sizes() const {
    const std::string& unit = size_title().unit.empty() ? options_.unit : size_title().unit;
    return unit != "mm" && unit != "cm" && unit != "m" && unit != kInches;
  }

  [[nodiscard]] bool may_have_thousands_of_values() const {
    const SieveMeasure measure = value_title().measure;
    return measure != SieveMeasure::percent && measure != SieveMeasure::share;
  }

  [[nodiscard]] std::string plain(const CsvRow& row, std::size_t column, const csv::DecimalMarks& marks) const {
    try {
      return csv::plain_numbers(row.cells[column], marks);
    } catch (const InputError& e) {
      throw InputError(fmt::format("{}: column \"{}\": {}", csv_.where(row.line), title_of(column), e.what()));
    }
  }

  /// Sorts the rows of sizes from a total and from text below the table.
  void read_lines() {
    const csv::DecimalMarks sizes = marks_of(choice_.size, may_have_thousands_of_sizes());
    const csv::DecimalMarks values = marks_of(choice_.value, may_have_thousands_of_values());
    bool below = false;              // the table seems to have ended
    const CsvRow* unread = nullptr;  // a row below that end which is no size: only where sizes go on, it had not ended
    int before = csv_.header_line();
    for (const CsvRow& row : csv_.rows()) {
      below = below || (!lines_.empty() && row.line > before + 1);
      before = row.line;
      const std::string& cell = row.cells[choice_.size];
      const auto first = std::ranges::find_if(row.cells, [](const std::string& c) { return !c.empty(); });
      if (first == row.cells.end()) continue;
      const std::string& label = *first;
      SieveLine line{sieve_size(plain(row, choice_.size, sizes)), "", row.cells[choice_.value], row.line};
      if (!csv::is_missing(line.cell)) line.value = plain(row, choice_.value, values);
      if (cell.empty() && sieve_size(label).kind == SieveSize::Kind::pan) line.size.kind = SieveSize::Kind::pan;
      if (line.value.empty() && &label != &cell && is_footer(label)) {
        below = true;
      } else if (line.size.kind != SieveSize::Kind::none) {
        if (unread != nullptr) refuse_size(*unread);
        lines_.push_back(std::move(line));
      } else if (is_total(label) || (cell.empty() && !passes())) {
        if (cell.empty() && !is_total(label) && !is_footer(label) && unread == nullptr) unread = &row;
        if (!line.value.empty()) total_ = std::move(line);
        below = true;
      } else if (!is_footer(label) && has_number(line.value)) {
        if (!below) refuse_size(row);
        if (unread == nullptr) unread = &row;
      }
    }
  }

  static bool has_number(const std::string& text) { return text.find_first_of("0123456789") != std::string::npos; }
  static bool starts_with_any(const std::string& cell, std::initializer_list<const char*> words) {
    const std::string text = csv::folded(cell);
    return std::ranges::any_of(words, [&](const char* word) { return text.starts_with(word); });
  }
  static bool is_total(const std::string& cell) {
    return starts_with_any(cell, {"total", "sum", "somme", "gesamt", "ensemble"});
  }
  /// Results and remarks that laboratories write below their tables.
  static bool is_footer(const std::string& cell) {
    return starts_with_any(cell, {"d1",      "d3",     "d5",       "d6",      "d9",       "cu",       "cc",
                                  "u ",      "u=",     "loss",     "verlust", "perte",    "diff",     "moisture",
                                  "wasser",  "teneur", "fineness", "module",  "einwaage", "masse",    "mass",
                                  "initial", "dry",    "date",     "datum",   "tested",   "operator", "bearbeiter"});
  }

  [[noreturn]] void refuse_size(const CsvRow& row) const {
    const std::string& cell = row.cells[choice_.size];
    if (cell.empty()) throw InputError(csv_.where(row.line) + ": the opening is missing");
    throw InputError(fmt::format("{}: \"{}\" is no size of a sieve: write e.g. 0.5 mm, 500 um, No. 35, 3/8 in., pan",
                                 csv_.where(row.line), cell));
  }

  /// Numbers of sizes without a unit of their own.
  [[nodiscard]] std::vector<std::string> bare_sizes() const {
    std::vector<std::string> bare;
    for (const SieveLine& l : lines_)
      if (l.size.unit.empty() && !l.size.number.empty() && l.size.number.find_first_not_of("0.") != std::string::npos)
        bare.push_back(l.size.number);
    return bare;
  }

  [[nodiscard]] std::string unit_of_sizes() {
    const std::vector<std::string> bare = bare_sizes();
    const SieveTitle& title = size_title();
    const bool mesh =
        title.unit == kMesh || std::ranges::any_of(lines_, [](const SieveLine& l) { return l.size.unit == kMesh; });
    if (mesh) return unit_of_mesh(bare);
    if (!options_.unit.empty()) {
      if (!title.unit.empty() || bare.empty()) refuse_unit();
      return options_.unit;
    }
    if (!title.unit.empty() || bare.empty()) return title.unit;
    if (choice_.titles[choice_.size].column == SieveColumn::name) return kAstmNumbers;
    if (const auto unit = unit_of_numbers(bare)) {
      remarks_.push_back(fmt::format("sizes have no unit; as openings of ISO 565 they can only be in {}", *unit));
      return *unit;
    }
    throw InputError(
        fmt::format("{}column \"{}\": no unit: give unit = \"mm\" (or um, cm, in, phi, astm) {}; or write "
                    "it behind the name, e.g. opening [mm]",
                    head(), title_of(choice_.size), kInScene));
  }

  [[noreturn]] void refuse_unit() const {
    throw InputError(
        fmt::format("{}column \"{}\" says the unit of its sizes: unit = \"{}\" has no effect; leave it out", head(),
                    title_of(choice_.size), options_.unit));
  }

  [[nodiscard]] std::string unit_of_mesh(std::vector<std::string> numbers) const {
    for (const SieveLine& l : lines_)
      if (l.size.unit == kMesh) numbers.push_back(l.size.number);
    const bool sure = are_astm_numbers(numbers);
    if (!options_.unit.empty() && (sure || options_.unit != kAstmNumbers)) refuse_unit();
    if (sure || !options_.unit.empty()) return kAstmNumbers;
    throw InputError(
        fmt::format("{}column \"{}\": mesh of ASTM E11 or of Tyler? Give unit = \"astm\" {}, or openings "
                    "in mm",
                    head(), title_of(choice_.size), kInScene));
  }

  [[nodiscard]] double diameter(const SieveLine& l, const std::string& number) const {
    const std::string& unit = l.size.unit.empty() ? unit_ : l.size.unit;
    const bool fractions = std::ranges::any_of(lines_, [](const SieveLine& other) {
      return other.size.number.find('/') != std::string::npos || other.size.unit == kAstmNumbers;
    });
    const bool nominal = number.find('.') == std::string::npos && (fractions || !l.size.unit.empty());
    try {
      return sieve_diameter(number, unit, nominal);
    } catch (const InputError& e) {
      throw InputError(fmt::format("{}: column \"{}\": {}", csv_.where(l.line), title_of(choice_.size), e.what()));
    }
  }

  /// The pan by its name, as an opening of 0, or as "-63" below classes such as "-125 +63".
  [[nodiscard]] bool is_pan(const SieveLine& l) const {
    const std::string& unit = l.size.unit.empty() ? unit_ : l.size.unit;
    const bool zero = l.size.number.find_first_not_of("+-0.") == std::string::npos;
    const bool classes = std::ranges::any_of(lines_, [](const SieveLine& other) { return !other.size.upper.empty(); });
    const bool below = classes && l.size.number.starts_with('-');
    return l.size.kind == SieveSize::Kind::pan ||
           ((zero || below) && unit != kPhi && unit != kAstmNumbers && unit != kMesh);
  }

  /// Brings values into one form, sieves from the coarsest to the finest; true when there is a pan.
  bool gather() {
    data_.where_header = head();
    data_.title = title_of(choice_.value);
    data_.measure = value_title().measure;
    if (data_.measure == SieveMeasure::length)
      throw InputError(fmt::format("{}{} is in percent of mass or a share: \"{} [%]\", not [{}]", head(),
                                   passes() ? "passing" : "what is retained", passes() ? "passing" : "retained",
                                   value_title().unit));
    for (const SieveLine& l : lines_) {
      const std::string where = csv_.where(l.line);
      if (is_pan(l)) {
        if (data_.pan) throw InputError(where + ": the pan is there twice");
        data_.pan = RetainedRow{0.0, 0.0, value(l, true), where, l.cell};
        if (!l.size.number.empty()) pan_below_ = std::abs(diameter(l, l.size.number));
        continue;
      }
      RetainedRow row{diameter(l, l.size.number), 0.0, value(l, false), where, l.cell};
      if (!(row.opening > 0.0)) throw InputError(where + ": an opening must be positive");
      if (!l.size.upper.empty()) row.upper = diameter(l, l.size.upper);
      data_.rows.push_back(row);
    }
    if (!total_.value.empty()) data_.total = value(total_, false);
    std::ranges::stable_sort(data_.rows, std::ranges::greater{}, &RetainedRow::opening);
    check_pan_size();
    check_classes();
    return data_.pan.has_value();
  }

  void check_classes() const {
    for (std::size_t k = 1; k < data_.rows.size(); ++k) {
      const RetainedRow& row = data_.rows[k];
      const double next = data_.rows[k - 1].opening;
      if (row.upper > 0.0 && std::abs(row.upper - next) > 1e-6 * next)
        throw InputError(fmt::format("{}: the class ends at {:g} mm, the next begins at {:g} mm", row.where,
                                     1e3 * row.upper, 1e3 * next));
    }
  }

  void check_pan_size() const {
    if (!(pan_below_ > 0.0) || data_.rows.empty()) return;
    const double finest = data_.rows.back().opening;
    if (std::abs(pan_below_ - finest) > 1e-6 * finest)
      throw InputError(fmt::format("{}: below {:g} mm, but the finest sieve is {:g} mm", data_.pan->where,
                                   1e3 * pan_below_, 1e3 * finest));
  }

  /// Number of a cell in percent, as a share, or as a mass, as the column has it.
  [[nodiscard]] double value(const SieveLine& l, bool may_miss) const {
    if (l.value.empty()) {
      if (may_miss) return std::nan("");
      throw InputError(
          fmt::format("{}: {} is missing", csv_.where(l.line), passes() ? "what passes" : "what is retained"));
    }
    std::string text = l.value;
    const bool sign = text.back() == '%';
    if (sign) text = trimmed(text.substr(0, text.size() - 1));
    try {
      const bool mass = !text.empty() && std::isalpha(static_cast<unsigned char>(text.back())) != 0;
      if (mass) return parse_quantity(text, Unit::mass) / mass_unit();
      return parse_quantity(text, Unit::none) / (sign || data_.measure == SieveMeasure::percent ? 100.0 : 1.0);
    } catch (const InputError& e) {
      throw InputError(
          fmt::format("{}: column \"{}\": \"{}\" {}", csv_.where(l.line), title_of(choice_.value), l.cell, e.what()));
    }
  }

  /// Masses only count over each other, so that pounds do as well as grams.
  [[nodiscard]] double mass_unit() const {
    try {
      return parse_quantity("1 " + value_title().unit, Unit::mass);
    } catch (const InputError&) {
      return 1.0;
    }
  }

  std::vector<SieveRow> passing_rows(bool pan_row) {
    if (pan_row && data_.pan->value > kSieveRounding)
      throw InputError(fmt::format("{}: nothing passes a pan; {} is given", data_.pan->where, data_.pan->cell));
    double full = 1.0;
    if (data_.measure == SieveMeasure::mass || data_.measure == SieveMeasure::unknown) full = full_passing();
    std::vector<SieveRow> rows;
    for (const RetainedRow& r : data_.rows) {
      const SieveRow row{r.opening, snapped(full == 1.0 ? r.value : r.value / full), r.where};
      if (row.passing < 0.0 || row.passing > 1.0)
        throw InputError(fmt::format(
            "{}: {} passes; allowed: 0 to {}", r.where, r.cell,
            data_.measure == SieveMeasure::percent ? "100 %" : "1 (a share; write \"passing [%]\" for percent)"));
      rows.push_back(row);
    }
    return rows;
  }

  /// What counts as all in a column of masses, or without a unit.
  [[nodiscard]] double full_passing() {
    double most = 0.0;
    for (const RetainedRow& r : data_.rows) most = std::max(most, r.value);
    if (data_.measure == SieveMeasure::mass) return data_.total.value_or(most) > 0.0 ? data_.total.value_or(most) : 1.0;
    const bool percent = std::abs(most - 100.0) < 100.0 * kSieveRounding;
    if (percent) remarks_.push_back("passing has no unit; it ends at 100, so it is in percent");
    return percent ? 100.0 : 1.0;
  }

  std::vector<SieveRow> retained_rows() {
    RetainedCurve curve = passing_of_retained(data_, choice_.meaning);
    choice_.meaning = curve.meaning;
    remarks_.insert(remarks_.end(), curve.remarks.begin(), curve.remarks.end());
    std::vector<SieveRow> rows;
    for (std::size_t k = 0; k < data_.rows.size(); ++k)
      rows.push_back({data_.rows[k].opening, snapped(curve.passing[k]), data_.rows[k].where});
    return rows;
  }

  /// The sizes below and above all grains, from the scene or from the class of the coarsest grains.
  void add_ends(std::vector<SieveRow>& rows) const {
    const auto by_opening = [](const SieveRow& a, const SieveRow& b) { return a.opening < b.opening; };
    if (rows.empty()) return;
    const SieveRow finest = *std::ranges::min_element(rows, by_opening);
    const SieveRow coarsest = *std::ranges::max_element(rows, by_opening);
    const double class_end = data_.rows.front().upper;
    if (options_.smallest) rows.push_back(end_row("smallest", *options_.smallest, finest, 0.0));
    if (options_.largest)
      rows.push_back(end_row("largest", *options_.largest, coarsest, 1.0));
    else if (class_end > coarsest.opening && coarsest.passing < 1.0)
      rows.push_back({class_end, 1.0, coarsest.where});
  }

  [[nodiscard]] SieveRow end_row(const char* key, double diameter, const SieveRow& end, double passing) const {
    const bool below = passing == 0.0;
    if (end.passing == passing)
      throw InputError(fmt::format("{} = {:g} mm has no effect: {} % pass the {} sieve ({:g} mm); leave it out", key,
                                   1e3 * diameter, below ? 0 : 100, below ? "finest" : "coarsest", 1e3 * end.opening));
    if (below ? diameter >= end.opening : diameter <= end.opening)
      throw InputError(fmt::format("{} = {:g} mm: must be {} the {} sieve, {:g} mm", key, 1e3 * diameter,
                                   below ? "below" : "above", below ? "finest" : "coarsest", 1e3 * end.opening));
    return {diameter, passing, end.where};
  }

  [[nodiscard]] std::string columns_text() const {
    const char* in = data_.measure == SieveMeasure::mass      ? ", masses"
                     : data_.measure == SieveMeasure::percent ? ", in percent"
                     : data_.measure == SieveMeasure::share   ? ", shares"
                                                              : "";
    return fmt::format("sizes \"{}\"{}; \"{}\": {}{}{}", title_of(choice_.size),
                       unit_.empty() || unit_ == size_title().unit ? "" : fmt::format(" [{}]", unit_),
                       title_of(choice_.value),
                       choice_.meaning == SieveColumn::retained ? "retained on each sieve" : to_string(choice_.meaning),
                       in, data_.pan ? "; with a pan" : "");
  }

  const CsvFile& csv_;
  const SieveOptions& options_;
  SieveChoice choice_;
  std::vector<SieveLine> lines_;
  SieveLine total_;
  std::string unit_;
  double pan_below_ = 0.0;  ///< size that a row of the pan says [m]
  RetainedTable data_;
  std::vector<std::string> remarks_;
};

std::optional<CsvFile> laboratory_table(const std::string& bytes, const std::string& path) {
  return CsvFile::find(bytes, path, are_sieve_columns, is_sieve_or_mass);
}

}  // namespace

SieveCurve read_sieve_file(const std::string& path, const SieveOptions& options, int dimension) {
  try {
    const std::string bytes = read_text(path);
    const std::optional<CsvFile> csv = laboratory_table(bytes, path);
    return SieveReader(csv ? *csv : CsvFile::parse(bytes, path, "opening [mm], passing [%]"), options).read(dimension);
  } catch (const InputError& e) {
    const std::string what = e.what();
    throw InputError(what.starts_with(path) ? what : path + ": " + what);
  }
}

bool is_sieve_file(const std::string& path) { return laboratory_table(read_text(path), path).has_value(); }

}  // namespace softgrain
