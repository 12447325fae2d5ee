#include "common/data/estimate_words.h"

#include <fmt/format.h>

#include <cmath>

#include "common/core/text.h"

namespace softgrain {

namespace {

int digits_for(double low, double high) { return digits_to_differ(low, high, 4, 12); }

}  // namespace

int digits_to_differ(double low, double high, int least, int most) {
  int digits = least;
  while (digits < most && rounded_text(low, {digits}) == rounded_text(high, {digits})) ++digits;
  return digits;
}

bool interval_known(double low, double high) { return std::isfinite(low) && std::isfinite(high) && low < high; }

std::string interval_text(double value, double low, double high) {
  if (!interval_known(low, high)) return fmt::format("{:.4g} (interval not determined)", value);
  const int digits = digits_for(low, high);
  return fmt::format("{:.{}g} ({:.{}g} to {:.{}g})", value, digits, low, digits, high, digits);
}

std::string bracket_text(const Estimate& e, double unit) {
  if (!interval_known(e.low, e.high)) return fmt::format("{:.4g} [not determined]", unit * e.value);
  const int digits = digits_for(unit * e.low, unit * e.high);
  return fmt::format("{:.{}g} [{:.{}g}, {:.{}g}]", unit * e.value, digits, unit * e.low, digits, unit * e.high, digits);
}

std::string ends_text(double low, double high, const EndsForm& form) {
  const bool known = form.may_be_equal ? std::isfinite(low) && std::isfinite(high) : interval_known(low, high);
  return known ? form.number(low, form.digits) + form.between + form.number(high, form.digits) : form.unknown;
}

std::string estimate_with_error(const Estimate& e, const EstimateForm& form) {
  const std::string value = form.number(e.value, 3);
  if (!std::isfinite(e.standard_error)) return value + form.unknown;
  return e.standard_error > 0.0 ? value + form.between + form.number(e.standard_error, 2) : value;
}

}  // namespace softgrain
