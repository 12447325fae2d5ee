// Records as attributes of a group and back, by their fields (common/data/fields.h): one list of names for both
// directions, with Limits and kLater as in columns.h. Numbers, flags (0 or 1), texts, words of an enum; an optional
// number that is unknown has no attribute.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>

#include "common/core/enum_names.h"
#include "common/data/columns.h"
#include "common/io/hdf5_file.h"

namespace softgrain {

/// visit(name, member, kIfAny): not written where it is an empty text, or NaN.
struct IfAny {};
inline constexpr IfAny kIfAny{};

namespace attributes {

template <class Wanted, class... Options>
inline constexpr bool has_option = (std::is_same_v<std::remove_cvref_t<Options>, Wanted> || ...);

inline bool is_empty(const std::string& text) { return text.empty(); }
inline bool is_empty(double number) { return std::isnan(number); }

template <class T>
void write(const h5::Group& group, const std::string& name, const T& value) {
  if constexpr (is_optional<T>) {
    if (value) write(group, name, *value);
  } else if constexpr (NamedEnum<T>) {
    group.attribute(name, to_string(value));
  } else if constexpr (std::is_integral_v<T>) {
    group.attribute(name, static_cast<std::int64_t>(value));
  } else {
    group.attribute(name, value);
  }
}

/// The limits among the options; none: any number, finite or not.
inline const Limits* limits_among() { return nullptr; }
template <class First, class... Options>
const Limits* limits_among(const First& first, const Options&... options) {
  if constexpr (std::is_same_v<First, Limits>)
    return &first;
  else
    return limits_among(options...);
}

template <class T>
void read(const h5::Group& group, const std::string& name, T& value, const Limits* limits) {
  if constexpr (is_optional<T>) {
    value.reset();
    if (group.has_attribute(name)) read(group, name, value.emplace(), limits);
  } else if constexpr (NamedEnum<T>) {
    value = read_word<T>(group, name);
  } else if constexpr (std::is_same_v<T, std::string>) {
    value = group.text(name);
  } else if constexpr (std::is_same_v<T, bool>) {
    value = group.integer(name) != 0;
  } else if constexpr (std::is_integral_v<T>) {
    value = static_cast<T>(group.integer(name));
    if (limits != nullptr) (void)read_attribute(group, name, *limits);
  } else {
    value = limits == nullptr ? group.number(name) : read_attribute(group, name, *limits);
  }
}

}  // namespace attributes

/// For records whose list of members is no fields(): list(AttributeWriter{group}, record).
struct AttributeWriter {
  const h5::Group& group;
  template <class T, class... Options>
  void operator()(const std::string& name, const T& value, const Options&...) const {
    if constexpr (attributes::has_option<IfAny, Options...>)
      if (attributes::is_empty(value)) return;
    attributes::write(group, name, value);
  }
};

struct AttributeReader {
  const h5::Group& group;
  template <class T, class... Options>
  void operator()(const std::string& name, T& value, const Options&... options) const {
    if constexpr (attributes::has_option<IfAny, Options...> || attributes::has_option<Later, Options...>)
      if (!group.has_attribute(name)) return;
    attributes::read(group, name, value, attributes::limits_among(options...));
  }
};

template <class Record>
void write_attributes(const h5::Group& group, const Record& record) {
  fields(AttributeWriter{group}, record);
}

/// Throws IoError when an attribute is missing, of another type or outside its limits.
template <class Record>
void read_attributes(const h5::Group& group, Record& record) {
  fields(AttributeReader{group}, record);
}

}  // namespace softgrain
