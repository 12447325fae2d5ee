// Parts of texts, numbers with their errors, and tables of texts.
#include "common/core/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace softgrain {

void append_part(std::string& text, std::string_view part, std::string_view separator) {
  if (!text.empty()) text += separator;
  text += part;
}

std::string shell_word(const std::string& word) {
  if (!word.empty() && word.find_first_of(" \t\n\"'\\$`*?[]{}()<>|&;#~!") == std::string::npos) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string without_trailing_zeros(std::string text) {
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string rounded_text(double value, const NumberForm& form, const char* undefined) {
  if (undefined != nullptr && !std::isfinite(value)) return undefined;
  if (form.fixed) return fmt::format(fmt::runtime(form.sign ? "{:+.{}f}" : "{:.{}f}"), value, form.digits);
  return fmt::format(fmt::runtime(form.sign ? "{:+.{}g}" : "{:.{}g}"), value, form.digits);
}

std::string percent_text(double share, const NumberForm& form, const char* undefined) {
  if (undefined != nullptr && !std::isfinite(share)) return undefined;
  return rounded_text(100.0 * share, form) + " %";
}

std::string pressure_text(double stress, int digits) {
  constexpr std::array<std::pair<double, const char*>, 3> kPrefixes{{{1e9, "GPa"}, {1e6, "MPa"}, {1e3, "kPa"}}};
  const auto* const at = std::ranges::find_if(kPrefixes, [&](const auto& p) { return std::abs(stress) >= p.first; });
  const bool none = at == kPrefixes.end();
  // Rounded first: "120 kPa" with two digits, not "1.2e+02 kPa".
  const double value =
      std::strtod(fmt::format("{:.{}e}", none ? stress : stress / at->first, digits - 1).c_str(), nullptr);
  const bool plain = std::abs(value) < 1e6 && std::abs(value) >= 1e-4;
  return fmt::format("{:.{}g} {}", value, plain ? std::max(digits, 6) : digits, none ? "Pa" : at->second);
}

std::optional<double> if_finite(double value) { return std::isfinite(value) ? std::optional(value) : std::nullopt; }

std::string with_error(double value, std::optional<double> error, const ErrorForm& form) {
  if (form.undefined != nullptr && !std::isfinite(value)) return form.undefined;
  const std::string text = rounded_text(value, form.value);
  return error ? text + form.between + rounded_text(*error, form.error) : text;
}

std::string with_error(const MeanError& mean, const ErrorForm& form) {
  return with_error(mean.mean, mean.n > 1 ? std::optional(mean.error) : std::nullopt, form);
}

namespace {

std::string quoted(const std::string& cell) {
  if (cell.find_first_of(",\"\n") == std::string::npos) return cell;
  std::string out = "\"";
  for (const char c : cell) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string csv_line(const std::vector<std::string>& cells) { return join_text(cells, ",", quoted) + "\n"; }

std::string markdown_line(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (std::string cell : cells) {
    std::replace(cell.begin(), cell.end(), '\n', ' ');
    std::replace(cell.begin(), cell.end(), '|', '/');
    line += " " + cell + " |";
  }
  return line + "\n";
}

}  // namespace

std::string as_csv(const TextTable& table) {
  std::string text = csv_line(table.header);
  for (const auto& row : table.rows) text += csv_line(row);
  return text;
}

std::string as_markdown(const TextTable& table) {
  std::string text = markdown_line(table.header) + "|";
  for (std::size_t k = 0; k < table.header.size(); ++k) text += "---|";
  text += "\n";
  for (const auto& row : table.rows) text += markdown_line(row);
  return text;
}

}  // namespace softgrain
