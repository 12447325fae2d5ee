#include "common/core/text.h"

#include <cmath>

namespace softgrain {

void append_part(std::string& text, std::string_view part, std::string_view separator) {
  if (!text.empty()) text += separator;
  text += part;
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

std::optional<double> if_finite(double value) { return std::isfinite(value) ? std::optional(value) : std::nullopt; }

std::string with_error(double value, std::optional<double> error, const ErrorForm& form) {
  if (form.undefined != nullptr && !std::isfinite(value)) return form.undefined;
  const std::string text = rounded_text(value, form.value);
  return error ? text + form.between + rounded_text(*error, form.error) : text;
}

std::string with_error(const MeanError& mean, const ErrorForm& form) {
  return with_error(mean.mean, mean.n > 1 ? std::optional(mean.error) : std::nullopt, form);
}

}  // namespace softgrain
