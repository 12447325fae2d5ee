#include "pipelines/report/axis.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "pipelines/report/number_format.h"

namespace softgrain::report {
namespace {

Axis linear_around(double low, double high) {
  if (low == high) {
    const double half = low == 0.0 ? 1.0 : 0.1 * std::abs(low);
    return {Scale::linear, low - half, high + half};
  }
  const double room = 0.04 * (high - low);
  const bool from_zero = low >= 0.0 && low < 0.35 * high;
  const bool to_zero = high <= 0.0 && high > 0.35 * low;
  return {Scale::linear, from_zero ? 0.0 : low - room, to_zero ? 0.0 : high + room};
}

Axis logarithmic_around(double low, double high) {
  const double room = std::max(std::pow(high / low, 0.05), 1.05);
  return {Scale::logarithmic, low / room, high * room};
}

/// Powers of ten between 1e-3 and 1e4 are written out, the others as 10ⁿ.
std::string decade_label(int mantissa, int exponent) {
  if (exponent >= -3 && exponent <= 3) return format_number(mantissa * std::pow(10.0, exponent), 3);
  return (mantissa == 1 ? "" : format_number(mantissa, 1) + "\u00d7") + "10" + superscript(exponent);
}

/// Whether a tick with mantissa 1..9 carries a label when the axis spans this many decades.
bool labelled(int mantissa, int exponent, double decades) {
  if (decades < 0.8) return true;
  if (decades < 3.2) return mantissa == 1 || mantissa == 2 || mantissa == 5;
  const int every = std::max(1, static_cast<int>(std::ceil(decades / 8.0)));
  return mantissa == 1 && exponent % every == 0;
}

/// Room at the ends of an axis must not reach beyond all numbers.
bool can_be_drawn(Scale scale, double value) {
  constexpr double kLargest = 1e100;
  if (!(std::abs(value) < kLargest)) return false;
  return scale == Scale::linear || value > 1.0 / kLargest;
}

}  // namespace

double nice_step(double range, int target) {
  const double raw = range / std::max(1, target);
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double ratio = raw / power;
  if (ratio < 1.5) return power;
  if (ratio < 3.5) return 2.0 * power;
  if (ratio < 7.5) return 5.0 * power;
  return 10.0 * power;
}

Axis::Axis(Scale scale, double low, double high) : scale_(scale), low_(low), high_(high) {
  if (!std::isfinite(low) || !std::isfinite(high) || !(low < high))
    throw std::invalid_argument("axis: low must be below high");
  if (scale == Scale::logarithmic && !(low > 0.0))
    throw std::invalid_argument("logarithmic axis: low must be positive");
}

Axis Axis::around(Scale scale, std::span<const double> values) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const double v : values) {
    if (!can_be_drawn(scale, v)) continue;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  if (low > high) return scale == Scale::linear ? Axis(scale, 0.0, 1.0) : Axis(scale, 0.1, 1.0);
  return scale == Scale::linear ? linear_around(low, high) : logarithmic_around(low, high);
}

bool Axis::drawable(double value) const { return can_be_drawn(scale_, value); }

double Axis::position(double value) const {
  if (!drawable(value)) return std::numeric_limits<double>::quiet_NaN();
  if (scale_ == Scale::linear) return (value - low_) / (high_ - low_);
  return std::log(value / low_) / std::log(high_ / low_);
}

int Axis::exponent() const {
  if (scale_ == Scale::logarithmic) return 0;
  const double largest = std::max(std::abs(low_), std::abs(high_));
  const int power = static_cast<int>(std::floor(std::log10(largest)));
  return power >= -3 && power < 5 ? 0 : power;
}

std::vector<Tick> Axis::ticks(int target) const {
  return scale_ == Scale::linear ? linear_ticks(target) : logarithmic_ticks();
}

std::vector<Tick> Axis::linear_ticks(int target) const {
  const double step = nice_step(high_ - low_, target);
  const double factor = std::pow(10.0, exponent());
  const int decimals = std::clamp(-static_cast<int>(std::floor(std::log10(step / factor) + 1e-9)), 0, 12);
  const double tolerance = 1e-9 * (high_ - low_);
  std::vector<Tick> result;
  for (auto k = static_cast<long long>(std::ceil((low_ - tolerance) / step));
       static_cast<double>(k) * step <= high_ + tolerance; ++k) {
    const double value = static_cast<double>(k) * step;
    result.push_back({value, format_fixed(value / factor, decimals)});
  }
  return result;
}

std::vector<Tick> Axis::logarithmic_ticks() const {
  const double decades = std::log10(high_ / low_);
  const int first = static_cast<int>(std::floor(std::log10(low_)));
  const int last = static_cast<int>(std::ceil(std::log10(high_)));
  std::vector<Tick> result;
  for (int exponent = first; exponent <= last; ++exponent) {
    for (int mantissa = 1; mantissa <= 9; ++mantissa) {
      const double value = mantissa * std::pow(10.0, exponent);
      if (value < low_ * (1.0 - 1e-9) || value > high_ * (1.0 + 1e-9)) continue;
      result.push_back({value, labelled(mantissa, exponent, decades) ? decade_label(mantissa, exponent) : ""});
    }
  }
  return result;
}

}  // namespace softgrain::report
