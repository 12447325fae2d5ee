// Texts made of parts, and numbers with their errors: one function for each, whose forms the callers choose. Tables of
// texts as CSV and Markdown.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <iterator>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/statistics.h"

namespace softgrain {

/// "a, b, c": texts or numbers with a separator between each two. An empty range gives "".
template <std::ranges::input_range Range>
std::string join_text(const Range& parts, std::string_view separator = ", ") {
  return fmt::format("{}", fmt::join(std::ranges::begin(parts), std::ranges::end(parts), separator));
}

/// "soft-solid and soft-soft": the same of the text that a function, or a member of each part, gives.
template <std::ranges::input_range Range, class TextOf>
requires std::invocable<TextOf&, std::ranges::range_reference_t<const Range>> std::string join_text(
    const Range& parts, std::string_view separator, TextOf text_of) {
  std::vector<std::string> texts;
  std::ranges::transform(parts, std::back_inserter(texts), text_of);
  return join_text(texts, separator);
}

/// Adds a part to a text: "a" becomes "a; b". The first part has no separator before it. An empty part that is not the
/// first leaves a separator at the end.
void append_part(std::string& text, std::string_view part, std::string_view separator = "; ");

/// "1 sample", "3 samples": a number and what it counts. `many`: the plural, where it is not that with an s.
std::string counted(std::int64_t count, std::string_view one, std::string_view many = "");

/// A word as a shell reads it back: in quotes where it needs them.
std::string shell_word(const std::string& word);

/// Whether a text has no control characters: line breaks, tabs, what moves the cursor of a terminal.
bool is_one_line(std::string_view text);

/// The text with spaces in place of its control characters.
std::string on_one_line(std::string text);

/// "0.25" of "0.250000", "1" of "1.00"; a text without a decimal point stays.
std::string without_trailing_zeros(std::string text);

/// How a number is written.
struct NumberForm {
  int digits = 4;      ///< significant digits, or decimals
  bool fixed = false;  ///< "0.7105" of {4, true}: `digits` are decimals. Otherwise as printf's %g: "1.2e+05" of {2}
  bool sign = false;   ///< "+1.3": a sign before positive numbers, too
};

/// "0.7105". With `undefined`, this text stands for a number that is not finite.
std::string rounded_text(double value, const NumberForm& form = {}, const char* undefined = nullptr);

/// "12.5 %" of the share 0.125. With `undefined`, this text stands for a share that is not finite.
std::string percent_text(double share, const NumberForm& form = {1, true}, const char* undefined = nullptr);

/// "50 kPa", "-1 MPa": a stress in Pa as messages give it.
std::string pressure_text(double stress, int digits = 6);

/// "650 +- 20 MPa" of a mean in Pa; a single value has no error.
std::string pressure_text(const MeanError& mean);

/// The number if it is finite.
std::optional<double> if_finite(double value);

/// How a number with its error is written.
struct ErrorForm {
  NumberForm value = {};
  NumberForm error = {2};
  const char* between = " +- ";
  const char* undefined = nullptr;  ///< the text for a value that is not finite; by default as printf writes it
};

/// "0.7105 +- 0.0011"; "0.7105" without an error.
std::string with_error(double value, std::optional<double> error, const ErrorForm& form = {});

/// "0.7105 +- 0.0011" of a mean; a single value has no error.
std::string with_error(const MeanError& mean, const ErrorForm& form = {});

struct TextTable {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

std::string as_csv(const TextTable& table);  ///< cells with commas, quotes or line ends are quoted
std::string as_markdown(const TextTable& table);

}  // namespace softgrain
