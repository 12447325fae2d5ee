// Records to columns and back: a vector of structs is stored as one data set per field.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "common/core/error.h"
#include "common/core/words.h"
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

  static Limits not_negative() { return {0.0, std::numeric_limits<double>::infinity()}; }
  static Limits flag() { return {0.0, 1.0}; }
};

/// Of overlaps over the radius of the shell: beyond, two bodies have passed each other.
inline constexpr Limits kOverlaps{0.0, 2.0};

/// An index of a list that long. Throws FileTrouble: "`what` out of range".
inline std::int64_t below(std::int64_t value, std::size_t length, const char* what) {
  if (value < 0 || static_cast<std::uint64_t>(value) >= length) throw FileTrouble(std::string(what) + " out of range");
  return value;
}

/// What a data set must be to be taken for what its name says. All throw FileTrouble that names it and what is there.
void require_unit(const h5::Group& group, const std::string& name, const std::string& unit);
void require_shape(const h5::Group& group, const std::string& name, const h5::Shape& shape);
void require_within(double value, const Limits& limits, const std::string& name, std::size_t row);

/// Finite numbers of this unit, shape and range, row by row. Throws FileTrouble.
std::vector<double> read_numbers(const h5::Group& group, const std::string& name, const std::string& unit,
                                 const h5::Shape& shape, const Limits& limits = {});

/// A finite number within limits that is an attribute of the group. Throws FileTrouble.
double read_attribute(const h5::Group& group, const std::string& name, const Limits& limits = {});

/// A word of an enum that is an attribute of the group. Throws FileTrouble for any other.
template <Worded Enum>
Enum read_word(const h5::Group& group, const std::string& name) {
  const std::string text = group.text(name);
  if (const auto value = from_word<Enum>(text)) return *value;
  throw FileTrouble("attribute '" + name + "' is '" + text + "', which is not known");
}

/// Number of records of a group: the length of its data set `name`.
std::size_t column_length(const h5::Group& group, const std::string& name);

/// Reads the data set into set(record, value) of every record; the numbers may be anything. Throws FileTrouble when
/// length or unit are others.
template <class Record, class Set>
void read_doubles(const h5::Group& group, const std::string& name, const std::string& unit,
                  std::vector<Record>& records, Set set) {
  require_shape(group, name, {records.size()});
  require_unit(group, name, unit);
  const std::vector<double> values = group.doubles(name);
  for (std::size_t k = 0; k < records.size(); ++k) set(records[k], values[k]);
}
/// The same for numbers that everything else is worked out from. Throws FileTrouble also when one is not finite, or
/// outside limits.
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

/// Hands out consecutive parts of a long list; a part that reaches beyond the end means a damaged file.
class Slices {
 public:
  explicit Slices(std::size_t total) : total_(total) {}
  /// First index of the next `length` elements. Throws FileTrouble.
  std::size_t next(std::int64_t length) {
    if (length < 0 || static_cast<std::uint64_t>(length) > total_ - used_)
      throw FileTrouble("counts do not fit the data");
    const std::size_t first = used_;
    used_ += static_cast<std::size_t>(length);
    return first;
  }
  /// Throws FileTrouble unless everything was handed out.
  void finish() const {
    if (used_ != total_) throw FileTrouble("counts do not fit the data");
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
