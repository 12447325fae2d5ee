// Names in scenes, files and texts: the words of a choice in one table beside each enum, and whose fields() name what.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace softgrain {

template <class Enum>
struct Word {
  Enum value;
  const char* text;
};

template <class Enum, std::size_t kCount>
constexpr std::array<Word<Enum>, kCount> word_list(const Word<Enum> (&list)[kCount]) {
  return std::to_array(list);
}

/// Every value of an enum and its word, in the order in which messages list them:
/// template <> inline constexpr auto words<Colour> = word_list<Colour>({{Colour::red, "red"}, ...});
template <class Enum>
inline constexpr auto words = nullptr;

template <class Enum>
concept Worded = std::is_enum_v<Enum> && !std::is_null_pointer_v<std::remove_cv_t<decltype(words<Enum>)>>;

template <Worded Enum>
std::string to_string(Enum value) {
  for (const Word<Enum>& w : words<Enum>)
    if (w.value == value) return w.text;
  return "unknown";
}

/// The value that a word stands for; empty when it is none of the table's.
template <Worded Enum>
constexpr std::optional<Enum> from_word(std::string_view text) {
  for (const Word<Enum>& w : words<Enum>)
    if (w.text == text) return w.value;
  return std::nullopt;
}

template <Worded Enum>
std::vector<const char*> all_words() {
  std::vector<const char*> out;
  for (const Word<Enum>& w : words<Enum>) out.push_back(w.text);
  return out;
}

/// A record, to read or to write: void fields(auto&& visit, Of<Point> auto& p) { visit("force", p.force); }
template <class T, class R>
concept Of = std::is_same_v<std::remove_const_t<T>, R>;

}  // namespace softgrain
