// Names in scenes, files and texts: one table of names beside each enum, and the records whose fields() name members.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace softgrain {

template <class Enum>
struct EnumName {
  Enum value;
  const char* text;
};

template <class Enum, std::size_t kCount>
constexpr std::array<EnumName<Enum>, kCount> enum_name_list(const EnumName<Enum> (&list)[kCount]) {
  return std::to_array(list);
}

/// Every value of an enum and its name, in the order in which messages list them:
/// template <> inline constexpr auto enum_names<Colour> = enum_name_list<Colour>({{Colour::red, "red"}, ...});
template <class Enum>
inline constexpr auto enum_names = nullptr;

template <class Enum>
concept NamedEnum = std::is_enum_v<Enum> && !std::is_null_pointer_v<std::remove_cv_t<decltype(enum_names<Enum>)>>;

template <NamedEnum Enum>
std::string to_string(Enum value) {
  for (const EnumName<Enum>& w : enum_names<Enum>)
    if (w.value == value) return w.text;
  return "unknown";
}

/// Names of earlier versions, which are still read: before, now.
inline constexpr std::array<std::array<std::string_view, 2>, 3> kOldNames{
    {{"bag", "isotropic"}, {"crowd", "multi-contact"}, {"stand-in", "substitute"}}};

/// The present name of what may be an earlier one.
constexpr std::string_view current_name(std::string_view name) {
  for (const auto& [before, now] : kOldNames)
    if (name == before) return now;
  return name;
}

/// The name that earlier versions gave to what has this one now; the same where it has not changed.
constexpr std::string_view earlier_name(std::string_view name) {
  for (const auto& [before, now] : kOldNames)
    if (name == now) return before;
  return name;
}

/// The value of a name; empty when the table does not have it.
template <NamedEnum Enum>
constexpr std::optional<Enum> parse_enum(std::string_view text) {
  for (const EnumName<Enum>& w : enum_names<Enum>)
    if (w.text == current_name(text)) return w.value;
  return std::nullopt;
}

template <NamedEnum Enum>
std::vector<const char*> all_enum_names() {
  std::vector<const char*> out;
  for (const EnumName<Enum>& w : enum_names<Enum>) out.push_back(w.text);
  return out;
}

/// A record, to read or to write: void fields(auto&& visit, Of<Point> auto& p) { visit("force", p.force); }
template <class T, class R>
concept Of = std::is_same_v<std::remove_const_t<T>, R>;

/// visit(name, member, Means{text, unit}): what a member is, for people; unit: "" of texts and choices, "1" of plain
/// numbers.
struct Means {
  const char* text;
  const char* unit = "";
};

/// Visitors with a member kDescribes want all members, those too that this record does not have.
template <class Visit>
concept Describes = requires(std::remove_cvref_t<Visit> visit) {
  visit.kDescribes;
};

/// Whether a member of a record may be without a value.
template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;

}  // namespace softgrain
