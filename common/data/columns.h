// Records to columns and back: a vector of structs is stored as one data set per field.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/core/enum_names.h"
#include "common/core/error.h"
#include "common/core/histogram.h"
#include "common/core/vec.h"
#include "common/io/hdf5_file.h"

namespace softgrain {

/// Writes field(record) of every record as the data set `name`; numbers with a fraction as doubles, all others as
/// int64.
template <class Record, class Field>
void write_column(const h5::Group& group, const std::string& name, const std::string& unit,
                  const std::vector<Record>& records, Field field) {
  using Value = std::decay_t<decltype(field(records.front()))>;
  using Stored = std::conditional_t<std::is_floating_point_v<Value>, double, std::int64_t>;
  std::vector<Stored> values;
  values.reserve(records.size());
  for (const Record& record : records) values.push_back(static_cast<Stored>(field(record)));
  group.write(name, std::span<const Stored>(values));
  group.attribute_of(name, "unit", unit);
}

/// What the numbers of a data set may be.
struct Limits {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();

  bool finite = true;  ///< false: anything may stand there, NaN too

  static Limits anything() {
    return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), false};
  }
  static Limits not_negative() { return {0.0, std::numeric_limits<double>::infinity()}; }
  static Limits flag() { return {0.0, 1.0}; }
};

/// Limits of overlaps over the radius of the shell. Beyond them two bodies have passed each other.
inline constexpr Limits kOverlaps{0.0, 2.0};

/// An index of a list that long. Throws IoError: "`what` out of range".
inline std::int64_t below(std::int64_t value, std::size_t length, const char* what) {
  if (value < 0 || static_cast<std::uint64_t>(value) >= length) throw IoError(std::string(what) + " out of range");
  return value;
}

/// What a data set must be to be taken for what its name says. All throw IoError that names it and what is there.
void require_unit(const h5::Group& group, const std::string& name, const std::string& unit);
void require_shape(const h5::Group& group, const std::string& name, const h5::Shape& shape);
void require_within(double value, const Limits& limits, const std::string& name, std::size_t row);

/// The numbers of a data set. Throws IoError where one is not finite.
std::vector<double> finite_numbers(const h5::Group& group, const std::string& name);

/// Throws IoError where a number of any data set in the group, or in the groups below, is not finite.
void require_finite_content(const h5::Group& group);

/// Finite numbers of this unit, shape and range, row by row. Throws IoError.
std::vector<double> read_numbers(const h5::Group& group, const std::string& name, const std::string& unit,
                                 const h5::Shape& shape, const Limits& limits = {});

/// A finite number within limits that is an attribute of the group. Throws IoError.
double read_attribute(const h5::Group& group, const std::string& name, const Limits& limits = {});

/// A word of an enum that is an attribute of the group. Throws IoError for any other.
template <NamedEnum Enum>
Enum read_word(const h5::Group& group, const std::string& name) {
  const std::string text = group.text(name);
  if (const auto value = parse_enum<Enum>(text)) return *value;
  throw IoError("attribute '" + name + "' is '" + text + "', which is not known");
}

/// Number of records of a group: the length of its data set `name`.
std::size_t column_length(const h5::Group& group, const std::string& name);

/// Reads the data set into set(record, value) of every record; the numbers may be anything. Throws IoError when
/// length or unit are others.
template <class Record, class Set>
void read_doubles(const h5::Group& group, const std::string& name, const std::string& unit,
                  std::vector<Record>& records, Set set) {
  require_shape(group, name, {records.size()});
  require_unit(group, name, unit);
  const std::vector<double> values = group.doubles(name);
  for (std::size_t k = 0; k < records.size(); ++k) set(records[k], values[k]);
}
/// Reads the data set into set(record, value) of every record, for numbers that everything else is computed from.
/// Throws IoError when length or unit are others, or when a number is not finite or outside the limits.
template <class Record, class Set>
void read_finite(const h5::Group& group, const std::string& name, const std::string& unit, std::vector<Record>& records,
                 Set set, const Limits& limits = {}) {
  const std::vector<double> values = read_numbers(group, name, unit, {records.size()}, limits);
  for (std::size_t k = 0; k < records.size(); ++k) set(records[k], values[k]);
}
/// Whole numbers, without unit.
template <class Record, class Set>
void read_integers(const h5::Group& group, const std::string& name, std::vector<Record>& records, Set set,
                   const Limits& limits = {}) {
  require_shape(group, name, {records.size()});
  require_unit(group, name, "1");
  const std::vector<std::int64_t> values = group.integers(name);
  for (std::size_t k = 0; k < records.size(); ++k) {
    require_within(static_cast<double>(values[k]), limits, name, k);
    set(records[k], values[k]);
  }
}

/// Data sets "NAME" of vectors, one row each.
template <class Record, class Field>
void write_vectors(const h5::Group& group, const std::string& name, const std::string& unit,
                   const std::vector<Record>& records, Field field) {
  std::vector<double> flat;
  flat.reserve(3 * records.size());
  for (const Record& record : records) {
    const Vec3 a = field(record);
    flat.insert(flat.end(), {a[0], a[1], a[2]});
  }
  group.write(name, std::span<const double>(flat), {records.size(), 3});
  group.attribute_of(name, "unit", unit);
}

template <class Record, class Set>
void read_vectors(const h5::Group& group, const std::string& name, const std::string& unit,
                  std::vector<Record>& records, Set set) {
  const std::vector<double> flat = read_numbers(group, name, unit, {records.size(), 3});
  for (std::size_t k = 0; k < records.size(); ++k)
    set(records[k], Vec3{{flat[3 * k], flat[3 * k + 1], flat[3 * k + 2]}});
}

/// Option of a field: files of earlier versions do not have it; the member keeps what it has.
struct Later {};
inline constexpr Later kLater{};
/// Option of a vector: a data set with three numbers a row, not one data set for each component.
struct AsRows {};
inline constexpr AsRows kAsRows{};
/// Option of an enum, stored as its number: the last value, and what is said of any other.
struct UpTo {
  template <class Enum>
  UpTo(Enum highest, const char* said) : last(static_cast<double>(highest)), unknown(said) {}
  double last;
  const char* unknown;
};

/// How a field is stored.
struct ColumnForm {
  std::string_view unit;
  Limits limits{};
  bool later = false;
  std::size_t width = 1;          ///< numbers in a row
  const char* unknown = nullptr;  ///< said of a number that is outside the limits; null: the number and the limits

  void take(const Limits& allowed) { limits = allowed; }
  void take(const Means&) {}  // for people
  void take(Later) { later = true; }
  void take(AsRows) { width = 3; }
  void take(const UpTo& known) {
    limits = {0.0, known.last};
    unknown = known.unknown;
  }
};

/// One column of a list of records: numbers with a fraction, or whole ones.
struct StoredColumn {
  std::string name;
  std::string unit;
  ColumnForm form;  ///< without its unit
  bool whole;
  std::vector<double> reals{};
  std::vector<std::int64_t> wholes{};

  void write(const h5::Group& group) const;
  /// Throws IoError where the numbers are not those of `length` records, of this unit and within the limits.
  void read(const h5::Group& group, std::size_t length);
  [[nodiscard]] bool is_there() const { return whole ? !wholes.empty() : !reals.empty(); }
};

/// Calls each(name, component, number, form) for every number among the fields of a record, see common/data/fields.h.
/// `component`: 'x', 'y' or 'z' of a vector, else 0.
template <class Record, class Each, class... Context>
void numbers_of_fields(Record& record, Each each, const Context&... context) {
  fields(
      [&](const auto& name, auto& member, const auto& unit, const auto&... options) {
        ColumnForm form{unit};
        (form.take(options), ...);
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(member)>, Vec3>)
          for (std::size_t k = 0; k < 3; ++k) each(name, "xyz"[k], member.v[k], form);
        else
          each(name, char{}, member, form);
      },
      record, context...);
}

template <class Record, class... Context>
std::vector<StoredColumn> columns_of(const Context&... context) {
  std::vector<StoredColumn> columns;
  const Record blank{};
  numbers_of_fields(
      blank,
      [&](const auto& name, char component, const auto& number, ColumnForm form) {
        if (form.width > 1 && component != 'x') return;
        std::string full = name;
        if (form.width == 1 && component != 0) full += std::string("_") + component;
        std::string unit(form.unit);
        form.unit = {};
        using Number = std::remove_cvref_t<decltype(number)>;
        columns.push_back({std::move(full), std::move(unit), form, !std::is_floating_point_v<Number>});
      },
      context...);
  return columns;
}

/// The fields of records as one data set each. `context`: what fields() takes beside the record.
template <class Record, class... Context>
void write_records(const h5::Group& group, const std::vector<Record>& records, const Context&... context) {
  std::vector<StoredColumn> columns = columns_of<Record>(context...);
  for (const Record& record : records) {
    auto column = columns.begin();
    numbers_of_fields(
        record,
        [&](const auto&, char component, const auto& number, const ColumnForm& form) {
          if (column->whole)
            column->wholes.push_back(static_cast<std::int64_t>(number));
          else
            column->reals.push_back(static_cast<double>(number));
          if (form.width == 1 || component == 'z') ++column;
        },
        context...);
  }
  for (const StoredColumn& column : columns) column.write(group);
}

/// Reads them back into as many records as there are. Throws IoError.
template <class Record, class... Context>
void read_records(const h5::Group& group, std::vector<Record>& records, const Context&... context) {
  std::vector<StoredColumn> columns = columns_of<Record>(context...);
  for (StoredColumn& column : columns)
    if (!column.form.later || group.has(column.name)) column.read(group, records.size());
  for (std::size_t k = 0; k < records.size(); ++k) {
    auto column = columns.begin();
    numbers_of_fields(
        records[k],
        [&](const auto&, char component, auto& number, const ColumnForm& form) {
          using Number = std::remove_cvref_t<decltype(number)>;
          const std::size_t at = form.width == 1 ? k : 3 * k + static_cast<std::size_t>(component - 'x');
          if (column->is_there())
            number = column->whole ? static_cast<Number>(column->wholes[at]) : static_cast<Number>(column->reals[at]);
          if (form.width == 1 || component == 'z') ++column;
        },
        context...);
  }
}

/// All numbers of all records one after the other, for checkpoints and tables of several columns.
template <class Record>
std::vector<double> rows_of(const std::vector<Record>& records) {
  std::vector<double> rows;
  for (const Record& record : records)
    numbers_of_fields(record, [&](const auto&, char, const auto& number, const ColumnForm&) {
      rows.push_back(static_cast<double>(number));
    });
  return rows;
}

template <class Record>
std::vector<Record> records_of(const std::vector<double>& rows) {
  std::vector<Record> records(rows.size() / columns_of<Record>().size());
  auto next = rows.begin();
  for (Record& record : records)
    numbers_of_fields(record, [&](const auto&, char, auto& number, const ColumnForm&) {
      number = static_cast<std::remove_cvref_t<decltype(number)>>(*next++);
    });
  return records;
}

/// Hands out consecutive parts of a long list; a part that reaches beyond the end means a damaged file.
class Slices {
 public:
  explicit Slices(std::size_t total) : total_(total) {}
  /// First index of the next `length` elements. Throws IoError.
  std::size_t next(std::int64_t length) {
    if (length < 0 || static_cast<std::uint64_t>(length) > total_ - used_) throw IoError("counts do not fit the data");
    const std::size_t first = used_;
    used_ += static_cast<std::size_t>(length);
    return first;
  }
  /// Throws IoError unless everything was handed out.
  void finish() const {
    if (used_ != total_) throw IoError("counts do not fit the data");
  }

 private:
  std::size_t total_;
  std::size_t used_ = 0;
};

/// The next `length` elements of a list.
template <class T>
std::vector<T> take(const std::vector<T>& all, Slices& slices, std::int64_t length) {
  const auto first = all.begin() + static_cast<std::ptrdiff_t>(slices.next(length));
  return {first, first + static_cast<std::ptrdiff_t>(length)};
}

/// A list within records: the elements of all records one after the other, and a column with the length of each.
template <class Record, class T>
struct ListColumn {
  const char* name;  ///< name of the column of lengths
  std::vector<T> Record::*list;

  /// Writes the lengths.
  void write(const h5::Group& group, const std::vector<Record>& records) const {
    write_column(group, name, "1", records, [this](const Record& r) { return (r.*list).size(); });
  }
  /// The elements of all records.
  [[nodiscard]] std::vector<T> joined(const std::vector<Record>& records) const {
    std::vector<T> all;
    for (const Record& r : records) all.insert(all.end(), (r.*list).begin(), (r.*list).end());
    return all;
  }
  /// Gives every record its own. Throws IoError unless the lengths add up to all there are.
  void read(const h5::Group& group, std::vector<Record>& records, const std::vector<T>& all) const {
    Slices slices(all.size());
    read_integers(group, name, records, [&](Record& r, std::int64_t length) { r.*list = take(all, slices, length); });
    slices.finish();
  }
};
template <class Record, class T>
ListColumn(const char*, std::vector<T> Record::*) -> ListColumn<Record, T>;  // clang 14 deduces none by itself

// Histograms.

/// Attributes `low`, `high` (ends of the range), `below`, `above` (numbers of values outside) and the data set
/// `counts`.
void write_histogram(const h5::Group& group, const Histogram& histogram);

/// Adds the counts of `more`, which has the same bins.
void add_counts(Histogram& sum, const Histogram& more);

}  // namespace softgrain
