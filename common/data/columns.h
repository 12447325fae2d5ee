// Records to columns and back: a vector of structs is stored as one data set per field.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "common/core/enum_names.h"
#include "common/core/error.h"
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

/// One column of a list of records: numbers with a fraction, or whole ones.
struct StoredColumn {
  std::string name;
  const char* unit;
  Limits limits;
  bool whole;
  std::vector<double> reals{};
  std::vector<std::int64_t> wholes{};

  void write(const h5::Group& group) const;
  /// Throws IoError where the numbers are not `length` ones of this unit within the limits.
  void read(const h5::Group& group, std::size_t length);
};

/// Calls each(name, number, unit, limits) for every number among the fields of a record, see common/data/fields.h;
/// those of a vector are NAME_x, NAME_y, NAME_z.
template <class Record, class Each>
void numbers_of_fields(Record& record, Each each) {
  fields(
      [&](const std::string& name, auto& member, const char* unit, const Limits& limits = {}) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(member)>, Vec3>)
          for (std::size_t k = 0; k < 3; ++k) each(name + "_" + "xyz"[k], member.v[k], unit, limits);
        else
          each(name, member, unit, limits);
      },
      record);
}

template <class Record>
std::vector<StoredColumn> columns_of() {
  std::vector<StoredColumn> columns;
  const Record blank{};
  numbers_of_fields(blank, [&](const std::string& name, const auto& number, const char* unit, const Limits& limits) {
    columns.push_back({name, unit, limits, std::is_integral_v<std::remove_cvref_t<decltype(number)>>});
  });
  return columns;
}

/// The fields of records as one data set each.
template <class Record>
void write_records(const h5::Group& group, const std::vector<Record>& records) {
  std::vector<StoredColumn> columns = columns_of<Record>();
  for (const Record& record : records) {
    auto column = columns.begin();
    numbers_of_fields(record, [&](const std::string&, const auto& number, const char*, const Limits&) {
      if (column->whole)
        column->wholes.push_back(static_cast<std::int64_t>(number));
      else
        column->reals.push_back(static_cast<double>(number));
      ++column;
    });
  }
  for (const StoredColumn& column : columns) column.write(group);
}

/// Reads them back into as many records as there are. Throws IoError.
template <class Record>
void read_records(const h5::Group& group, std::vector<Record>& records) {
  std::vector<StoredColumn> columns = columns_of<Record>();
  for (StoredColumn& column : columns) column.read(group, records.size());
  for (std::size_t k = 0; k < records.size(); ++k) {
    auto column = columns.begin();
    numbers_of_fields(records[k], [&](const std::string&, auto& number, const char*, const Limits&) {
      using Number = std::remove_cvref_t<decltype(number)>;
      number = column->whole ? static_cast<Number>(column->wholes[k]) : static_cast<Number>(column->reals[k]);
      ++column;
    });
  }
}

/// All numbers of all records one after the other, for checkpoints.
template <class Record>
std::vector<double> rows_of(const std::vector<Record>& records) {
  std::vector<double> rows;
  for (const Record& record : records)
    numbers_of_fields(record, [&](const std::string&, const auto& number, const char*, const Limits&) {
      rows.push_back(static_cast<double>(number));
    });
  return rows;
}

template <class Record>
std::vector<Record> records_of(const std::vector<double>& rows) {
  std::vector<Record> records(rows.size() / columns_of<Record>().size());
  auto next = rows.begin();
  for (Record& record : records)
    numbers_of_fields(record, [&](const std::string&, auto& number, const char*, const Limits&) {
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

}  // namespace softgrain
