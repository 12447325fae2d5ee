// Records to columns and back: a vector of structs is stored as one data set per field.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "common/core/error.h"
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

/// Reads the data set into set(record, value) of every record. Throws FileTrouble when its length is another.
template <class Record, class Set>
void read_doubles(const h5::Group& group, const std::string& name, std::vector<Record>& records, Set set) {
  const std::vector<double> values = group.doubles(name);
  if (values.size() != records.size()) throw FileTrouble("data set '" + name + "' has a wrong length");
  for (std::size_t k = 0; k < records.size(); ++k) set(records[k], values[k]);
}
/// The same for numbers that everything else is worked out from. Throws FileTrouble also when one is not finite.
template <class Record, class Set>
void read_finite(const h5::Group& group, const std::string& name, std::vector<Record>& records, Set set) {
  read_doubles(group, name, records, [&](Record& r, double value) {
    if (!std::isfinite(value))
      throw FileTrouble("data set '" + name + "' holds a number that is not finite, in row " +
                        std::to_string(&r - records.data()));
    set(r, value);
  });
}
template <class Record, class Set>
void read_integers(const h5::Group& group, const std::string& name, std::vector<Record>& records, Set set) {
  const std::vector<std::int64_t> values = group.integers(name);
  if (values.size() != records.size()) throw FileTrouble("data set '" + name + "' has a wrong length");
  for (std::size_t k = 0; k < records.size(); ++k) set(records[k], values[k]);
}

/// Number of records of a group: the length of its data set `name`.
inline std::size_t column_length(const h5::Group& group, const std::string& name) {
  return group.integers(name).size();
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
