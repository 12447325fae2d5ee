#include "common/data/estimate_words.h"

#include <fmt/format.h>

#include <cmath>

namespace softgrain {

namespace {

/// So many digits that the ends of an interval are not the same text.
int digits_for(double low, double high) {
  constexpr int kLeast = 4;
  constexpr int kMost = 12;
  int digits = kLeast;
  while (digits < kMost && fmt::format("{:.{}g}", low, digits) == fmt::format("{:.{}g}", high, digits)) ++digits;
  return digits;
}

}  // namespace

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

}  // namespace softgrain
