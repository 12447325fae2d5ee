// Members of records side by side in one data set, a row each. A list names them once, for both directions:
// list(visit, record) calls visit(member) in the order of the columns. A member may be a number, a flag, an enum, a
// vector, an array of these.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/core/error.h"
#include "common/io/hdf5_file.h"

namespace softgrain {

namespace rows {

/// Calls visit(number) for the numbers that a member is made of.
void each_number(auto& member, const auto& visit) {
  using Member = std::remove_cvref_t<decltype(member)>;
  if constexpr (std::is_arithmetic_v<Member> || std::is_enum_v<Member>)
    visit(member);
  else if constexpr (requires { member.v; })
    each_number(member.v, visit);
  else if constexpr (requires { member.row; })
    each_number(member.row, visit);
  else
    for (auto& part : member) each_number(part, visit);
}

/// Calls visit(number) for the numbers of a record's row.
void each_in_row(auto& record, const auto& list, const auto& visit) {
  list([&](auto& member) { each_number(member, visit); }, record);
}

struct Form {
  std::size_t width = 0;
  bool whole = true;  ///< no number has a fraction
};

Form form_of(const auto& record, const auto& list) {
  Form form;
  each_in_row(record, list, [&form](const auto& number) {
    ++form.width;
    if (std::is_floating_point_v<std::remove_cvref_t<decltype(number)>>) form.whole = false;
  });
  return form;
}

}  // namespace rows

/// The rows of all records, one after the other.
template <class Stored, class Record>
std::vector<Stored> flat_rows(std::span<const Record> records, const auto& list) {
  std::vector<Stored> out;
  for (const Record& record : records)
    rows::each_in_row(record, list, [&out](const auto& number) { out.push_back(static_cast<Stored>(number)); });
  return out;
}
template <class Stored, class Record>
std::vector<Stored> flat_rows(const std::vector<Record>& records, const auto& list) {
  return flat_rows<Stored>(std::span<const Record>(records), list);
}

namespace rows {

/// Whether a number with a fraction is within the limits of a whole one; what is no number is not.
template <class Number>
bool holds(double stored) {
  const double end = std::ldexp(1.0, std::numeric_limits<Number>::digits);
  return stored >= (std::is_signed_v<Number> ? -end : 0.0) && stored < end;
}

/// A number of a file as a member holds it. Throws IoError where a member of whole numbers cannot hold it.
template <class Number, class Stored>
Number number_of(Stored stored, const std::string& what) {
  if constexpr (std::is_enum_v<Number>) {
    return static_cast<Number>(number_of<std::underlying_type_t<Number>>(stored, what));
  } else if constexpr (std::is_same_v<Number, bool>) {
    return stored != 0;
  } else {
    bool fits = true;
    if constexpr (std::is_integral_v<Number> && std::is_integral_v<Stored>)
      fits = std::in_range<Number>(stored);
    else if constexpr (std::is_integral_v<Number>)
      fits = holds<Number>(stored);
    if (!fits) throw IoError("'" + what + "' holds a number out of range");
    return static_cast<Number>(stored);
  }
}

}  // namespace rows

/// Puts them back into records that are there. Throws IoError: "`what` has a wrong length".
template <class Stored, class Record>
void take_rows(const std::vector<Stored>& numbers, std::span<Record> records, const auto& list,
               const std::string& what) {
  const std::size_t width = records.empty() ? 0 : rows::form_of(records.front(), list).width;
  if (numbers.size() != records.size() * width) throw IoError("'" + what + "' has a wrong length");
  auto next = numbers.begin();
  for (Record& record : records)
    rows::each_in_row(record, list, [&](auto& number) {
      number = rows::number_of<std::remove_cvref_t<decltype(number)>>(*next++, what);
    });
}
template <class Stored, class Record>
void take_rows(const std::vector<Stored>& numbers, std::vector<Record>& records, const auto& list,
               const std::string& what) {
  take_rows(numbers, std::span<Record>(records), list, what);
}

/// As a data set of doubles, or of whole numbers where no member has a fraction; of one column without a second
/// dimension.
template <class Record>
void write_rows(const h5::Group& group, const std::string& name, const std::vector<Record>& records, const auto& list) {
  const rows::Form form = rows::form_of(Record{}, list);
  const h5::Shape shape = form.width == 1 ? h5::Shape{} : h5::Shape{records.size(), form.width};
  if (form.whole)
    group.write(name, flat_rows<std::int64_t>(records, list), shape);
  else
    group.write(name, flat_rows<double>(records, list), shape);
}

/// Reads it into the records that are there. Throws IoError unless the data set has a row for each.
template <class Record>
void read_rows(const h5::Group& group, const std::string& name, std::vector<Record>& records, const auto& list) {
  if (rows::form_of(Record{}, list).whole)
    take_rows(group.integers(name), records, list, name);
  else
    take_rows(group.doubles(name), records, list, name);
}

/// As many records as the data set has rows. Throws IoError for a row that is not whole.
template <class Record>
std::vector<Record> records_in_rows(const h5::Group& group, const std::string& name, const auto& list) {
  const rows::Form form = rows::form_of(Record{}, list);
  const std::size_t numbers = form.whole ? group.integers(name).size() : group.doubles(name).size();
  std::vector<Record> records(numbers / form.width);
  read_rows(group, name, records, list);
  return records;
}

/// One record as a data set of one dimension.
template <class Record>
void write_row(const h5::Group& group, const std::string& name, const Record& record, const auto& list) {
  if (rows::form_of(record, list).whole)
    group.write(name, flat_rows<std::int64_t>(std::span(&record, 1), list));
  else
    group.write(name, flat_rows<double>(std::span(&record, 1), list));
}

template <class Record>
void read_row(const h5::Group& group, const std::string& name, Record& record, const auto& list) {
  if (rows::form_of(record, list).whole)
    take_rows(group.integers(name), std::span(&record, 1), list, name);
  else
    take_rows(group.doubles(name), std::span(&record, 1), list, name);
}

}  // namespace softgrain
