#include "pipelines/report/number_format.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/text.h"

namespace softgrain::report {
namespace {

constexpr const char* kMinus = "\u2212";
constexpr const char* kNarrowSpace = "\u202f";

std::string typographic_minus(const std::string& text) {
  return !text.empty() && text.front() == '-' ? kMinus + text.substr(1) : text;
}

int decimal_exponent(double value) { return static_cast<int>(std::floor(std::log10(std::abs(value)))); }

}  // namespace

std::string superscript(int exponent) {
  static const std::array<const char*, 10> digits{"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                                  "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  std::string result;
  for (const char ch : fmt::format("{}", exponent)) {
    result += ch == '-' ? "\u207b" : digits[static_cast<std::size_t>(ch - '0')];
  }
  return result;
}

std::string format_fixed(double value, int decimals) {
  const std::string text = fmt::format("{:.{}f}", value, std::max(0, decimals));
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  return is_zero && text.front() == '-' ? text.substr(1) : typographic_minus(text);
}

std::string format_number(double value, int digits) {
  if (std::isnan(value)) return "\u2013";
  if (std::isinf(value)) return value > 0 ? "\u221e" : std::string(kMinus) + "\u221e";
  if (value == 0.0) return "0";
  const int exponent = decimal_exponent(value);
  const bool plain = exponent >= -4 && exponent < 6;
  const double shown = plain ? value : value / std::pow(10.0, exponent);
  const int decimals = plain ? std::max(0, digits - 1 - exponent) : digits - 1;
  const std::string text = without_trailing_zeros(fmt::format("{:.{}f}", shown, decimals));
  return typographic_minus(text) + (plain ? "" : "\u00d710" + superscript(exponent));
}

std::string format_count(std::int64_t count) {
  const std::string plain = fmt::format("{}", count);
  const std::size_t sign = plain.front() == '-' ? 1 : 0;
  std::string result;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const std::size_t left = plain.size() - i;
    if (i > sign && left % 3 == 0) result += kNarrowSpace;
    result += plain[i];
  }
  return typographic_minus(result);
}

std::string format_with_error(double value, double error) {
  const bool has_error = std::isfinite(error) && error > 1e-9 * std::abs(value);
  if (!std::isfinite(value) || !has_error) return format_number(value);
  const int largest = decimal_exponent(std::max(std::abs(value), error));
  const bool plain = largest >= -4 && largest < 6;
  const double factor = plain ? 1.0 : std::pow(10.0, largest);
  const int digits = 1 - decimal_exponent(error / factor);
  const double coarse =
      std::pow(10.0, std::max(0, -digits));  // above 1 when the digits of the error end before the point
  const auto shown = [&](double number) {
    const double scaled = number / factor;
    return format_fixed(coarse > 1.0 ? coarse * std::round(scaled / coarse) : scaled, std::min(digits, 12));
  };
  const std::string body = shown(value) + " \u00b1 " + shown(error);
  return plain ? body : "(" + body + ")\u00d710" + superscript(largest);
}

std::string format_seconds(double seconds) {
  if (!std::isfinite(seconds)) return "\u2013";
  if (seconds < 120.0) return format_number(seconds, 3) + " s";
  const auto total = static_cast<std::int64_t>(std::llround(seconds));
  if (total < 7200) return fmt::format("{} min {:02} s", total / 60, total % 60);
  return fmt::format("{} h {:02} min", total / 3600, total % 3600 / 60);
}

SiPrefix si_prefix(double largest) {
  static const std::array<SiPrefix, 7> table{
      {{1e-9, "n"}, {1e-6, "\u00b5"}, {1e-3, "m"}, {1.0, ""}, {1e3, "k"}, {1e6, "M"}, {1e9, "G"}}};
  if (!std::isfinite(largest) || largest == 0.0) return {};
  const int group = static_cast<int>(std::floor(std::log10(std::abs(largest)) / 3.0));
  return table[static_cast<std::size_t>(std::clamp(group + 3, 0, 6))];
}

}  // namespace softgrain::report
