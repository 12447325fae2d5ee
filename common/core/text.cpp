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

std::string counted(std::int64_t count, std::string_view one, std::string_view many) {
  if (count == 1) return fmt::format("1 {}", one);
  return many.empty() ? fmt::format("{} {}s", count, one) : fmt::format("{} {}", count, many);
}

std::string shell_word(const std::string& word) {
  if (!word.empty() && word.find_first_of(" \t\n\"'\\$`*?[]{}()<>|&;#~!") == std::string::npos) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

namespace {

bool is_control(unsigned char c) { return c < 0x20 || c == 0x7f; }

/// Bytes of the control character that begins at `at`; 0 where none does. U+0080 to U+009F have two in UTF-8, and
/// terminals take U+009B like the escape character.
std::size_t control_size(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  if (is_control(byte(at))) return 1;
  const bool two = byte(at) == 0xc2 && at + 1 < text.size() && byte(at + 1) >= 0x80 && byte(at + 1) < 0xa0;
  return two ? 2 : 0;
}

}  // namespace

bool is_one_line(std::string_view text) {
  for (std::size_t k = 0; k < text.size(); ++k)
    if (control_size(text, k) > 0) return false;
  return true;
}

std::string on_one_line(std::string text) {
  for (std::size_t k = 0; k < text.size(); ++k)
    if (const std::size_t size = control_size(text, k); size > 0) text.replace(k, size, 1, ' ');
  return text;
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

namespace {

struct PressureUnit {
  double factor = 1.0;
  const char* symbol = "Pa";
};

/// The largest unit of which a stress [Pa] is one at least.
PressureUnit pressure_unit(double stress) {
  constexpr std::array<PressureUnit, 3> kUnits{{{1e9, "GPa"}, {1e6, "MPa"}, {1e3, "kPa"}}};
  const auto* const at = std::ranges::find_if(kUnits, [&](const auto& u) { return std::abs(stress) >= u.factor; });
  return at == kUnits.end() ? PressureUnit{} : *at;
}

/// Rounded to so many digits, then written without an exponent: "120" with two digits, not "1.2e+02".
std::string plain_digits(double number, int digits) {
  const double value = std::strtod(fmt::format("{:.{}e}", number, digits - 1).c_str(), nullptr);
  const bool plain = std::abs(value) < 1e6 && std::abs(value) >= 1e-4;
  return fmt::format("{:.{}g}", value, plain ? std::max(digits, 6) : digits);
}

}  // namespace

std::string pressure_text(double stress, int digits) {
  const PressureUnit unit = pressure_unit(stress);
  return plain_digits(stress / unit.factor, digits) + " " + unit.symbol;
}

std::string pressure_text(const MeanError& mean) {
  const PressureUnit unit = pressure_unit(mean.mean);
  const std::string error = mean.n > 1 ? " +- " + plain_digits(mean.error / unit.factor, 2) : "";
  return plain_digits(mean.mean / unit.factor, 4) + error + " " + unit.symbol;
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
