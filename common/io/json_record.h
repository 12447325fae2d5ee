// A record as a JSON object and back, by its fields: fields(visit, record) calls visit(name, member), see
// common/data/fields.h. A member may be a number (what is not finite is null), a flag, a text, a choice of
// enum_names<Enum>, a record, an optional of these (null when empty), a list or a map of them.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "common/core/enum_names.h"

namespace softgrain {

/// A struct whose members fields() names.
template <class T>
concept Fielded = std::is_class_v<T> && requires(T& record) {
  fields([](const auto&, auto&&, auto&&...) {}, record);
};

/// visit(name, member, kLeftOut): not written where there is nothing in it, an optional or a list without value, an
/// empty text.
struct LeftOut {};
inline constexpr LeftOut kLeftOut{};

/// [low, high] of two members under one name, for use in fields().
void range_field(auto&& visit, const std::string& name, auto& low, auto& high, const auto&... options) {
  std::array values{low, high};
  visit(name, values, options...);
  if constexpr (!std::is_const_v<std::remove_reference_t<decltype(low)>>) {
    low = values[0];
    high = values[1];
  }
}

namespace json_record {

template <class T>
inline constexpr bool is_list = false;
template <class T>
inline constexpr bool is_list<std::vector<T>> = true;
template <class T>
inline constexpr bool is_array = false;
template <class T, std::size_t kLength>
inline constexpr bool is_array<std::array<T, kLength>> = true;
template <class T>
inline constexpr bool is_map = false;
template <class T>
inline constexpr bool is_map<std::map<std::string, T>> = true;

template <class T, class... Options>
bool is_left_out(const T& member, const Options&...) {
  if constexpr (!(std::is_same_v<Options, LeftOut> || ...))
    return false;
  else if constexpr (is_optional<T>)
    return !member.has_value();
  else
    return member.empty();
}

}  // namespace json_record

template <class T>
nlohmann::json json_of(const T& value) {
  using nlohmann::json;
  if constexpr (is_optional<T>) {
    return value ? json_of(*value) : json(nullptr);
  } else if constexpr (json_record::is_list<T> || json_record::is_array<T>) {
    json out = json::array();
    for (const auto& one : value) out.push_back(json_of(one));
    return out;
  } else if constexpr (json_record::is_map<T>) {
    json out = json::object();
    for (const auto& [name, one] : value) out[name] = json_of(one);
    return out;
  } else if constexpr (NamedEnum<T>) {
    return to_string(value);
  } else if constexpr (std::is_floating_point_v<T>) {
    return std::isfinite(value) ? json(value) : json(nullptr);
  } else if constexpr (Fielded<const T>) {
    json out = json::object();
    fields(
        [&](const std::string& name, const auto& member, const auto&... options) {
          if (!json_record::is_left_out(member, options...)) out[name] = json_of(member);
        },
        value);
    return out;
  } else {
    return json(value);
  }
}

/// Takes from `at` what is there and of the right kind, and leaves the rest of `value` as it is: files are read that an
/// earlier version or another hand wrote. False where `at` as a whole is of another kind. Never throws.
template <class T>
bool read_json(const nlohmann::json& at, T& value) {
  if constexpr (std::is_same_v<T, nlohmann::json>) {
    value = at;
    return true;
  } else if constexpr (is_optional<T>) {
    value.reset();
    typename T::value_type inner{};
    if (at.is_null() || !read_json(at, inner)) return at.is_null();
    value = std::move(inner);
    return true;
  } else if constexpr (json_record::is_list<T>) {
    if (!at.is_array()) return false;
    value.clear();
    for (const nlohmann::json& one : at) {
      typename T::value_type inner{};
      (void)read_json(one, inner);
      value.push_back(std::move(inner));
    }
    return true;
  } else if constexpr (json_record::is_array<T>) {
    if (!at.is_array() || at.size() != value.size()) return false;
    for (std::size_t k = 0; k < value.size(); ++k) (void)read_json(at[k], value[k]);
    return true;
  } else if constexpr (json_record::is_map<T>) {
    if (!at.is_object()) return false;
    for (const auto& [name, one] : at.items()) (void)read_json(one, value[name]);
    return true;
  } else if constexpr (NamedEnum<T>) {
    const auto word = at.is_string() ? parse_enum<T>(at.template get_ref<const std::string&>()) : std::nullopt;
    if (word) value = *word;
    return word.has_value();
  } else if constexpr (std::is_same_v<T, bool>) {
    if (at.is_boolean()) value = at.template get<bool>();
    return at.is_boolean();
  } else if constexpr (std::is_floating_point_v<T>) {
    if (at.is_null()) value = std::numeric_limits<T>::quiet_NaN();
    if (at.is_number()) value = at.template get<T>();
    return at.is_null() || at.is_number();
  } else if constexpr (std::is_integral_v<T>) {
    if (at.is_number_integer()) value = at.template get<T>();
    return at.is_number_integer();
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (at.is_string()) value = at.template get<std::string>();
    return at.is_string();
  } else {
    static_assert(Fielded<T>);
    if (!at.is_object()) return false;
    fields(
        [&](const std::string& name, auto&& member, const auto&...) {
          if constexpr (!std::is_const_v<std::remove_reference_t<decltype(member)>>)
            if (const auto found = at.find(name); found != at.end()) (void)read_json(*found, member);
        },
        value);
    return true;
  }
}

/// A record of what is there; what is not there keeps its default.
template <class T>
T record_of(const nlohmann::json& at) {
  T value{};
  (void)read_json(at, value);
  return value;
}

}  // namespace softgrain
