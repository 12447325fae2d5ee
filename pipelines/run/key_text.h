// Keys of results that are kept for later runs: the text of every member of all that determines a result. A member that
// is added to such a record is part of the key, or does not compile, until somebody says that it changes nothing.
#pragma once

#include <fmt/format.h>

#include <array>
#include <concepts>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "common/core/enum_names.h"
#include "common/core/vec.h"
#include "common/packing/grading.h"

/// every_member(value): references to all members of TYPE, which are named in their order. The list is bound to the
/// whole of the record: with a member more or less it does not compile.
#define SOFTGRAIN_EVERY_MEMBER(TYPE, ...)   \
  auto every_member(Of<TYPE> auto& whole) { \
    auto& [__VA_ARGS__] = whole;            \
    return std::tie(__VA_ARGS__);           \
  }

namespace softgrain {

template <class T>
concept HasEveryMember = requires(const T& value) {
  every_member(value);
};

/// Texts of different values are different, numbers to the last bit; long texts up to a 64-bit hash.
class KeyText {
 public:
  template <class... T>
  explicit KeyText(const T&... values) {
    (add(values), ...);
  }

  KeyText& add(const std::string& value);
  KeyText& add(const char* value) { return add(std::string(value)); }
  KeyText& add(const Grading& value) { return add(value.text()); }

  template <class T>
  requires std::is_arithmetic_v<T> KeyText& add(T value) {
    if constexpr (std::is_floating_point_v<T>)
      return append(fmt::format("{:.17g}", value));
    else
      return append(fmt::format("{}", value));
  }
  template <class T>
  requires std::is_enum_v<T> KeyText& add(T value) {
    if constexpr (NamedEnum<T>)
      return append(to_string(value));
    else
      return add(static_cast<std::underlying_type_t<T>>(value));
  }
  template <class T>
  KeyText& add(const std::optional<T>& value) {
    return value ? append("some").add(*value) : append("none");
  }
  template <class T>
  KeyText& add(const std::vector<T>& values) {
    append(fmt::format("[{}", values.size()));
    for (const T& value : values) add(value);
    return append("]");
  }
  template <class T, std::size_t kCount>
  KeyText& add(const std::array<T, kCount>& values) {
    for (const T& value : values) add(value);
    return *this;
  }
  template <int D>
  KeyText& add(const Vec<D>& value) {
    return add(value.v);
  }
  template <HasEveryMember T>
  KeyText& add(const T& record) {
    append("{");
    std::apply([this](const auto&... members) { (add(members), ...); }, every_member(record));
    return append("}\n");
  }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  KeyText& append(const std::string& word) {
    text_ += word;
    text_ += ' ';
    return *this;
  }

  std::string text_;
};

}  // namespace softgrain
