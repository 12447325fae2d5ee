// One axis of a plot: range, linear or logarithmic scale, ticks at round values.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace softgrain::report {

enum class Scale { linear, logarithmic };

/// A tick; without label it is a minor one.
struct Tick {
  double value = 0.0;
  std::string label;
};

class Axis {
 public:
  /// Needs low < high, both positive on a logarithmic scale; throws std::invalid_argument otherwise.
  Axis(Scale scale, double low, double high);

  /// Smallest axis around the values, with some room at both ends; starts at zero when the data come near it.
  /// Values that cannot be drawn (not finite; not positive on a logarithmic scale) are passed over.
  static Axis around(Scale scale, std::span<const double> values);

  /// 0 at the low end, 1 at the high end, outside [0, 1] beyond; NaN when the value cannot be drawn.
  [[nodiscard]] double position(double value) const;
  [[nodiscard]] bool drawable(double value) const;

  /// Ticks in ascending order, about `target` of them labelled. On a linear axis the labels are in units of
  /// 10^exponent().
  [[nodiscard]] std::vector<Tick> ticks(int target = 6) const;
  /// Common power of ten taken out of the labels of a linear axis; 0 for ordinary magnitudes.
  [[nodiscard]] int exponent() const;

  [[nodiscard]] Scale scale() const { return scale_; }
  [[nodiscard]] double low() const { return low_; }
  [[nodiscard]] double high() const { return high_; }

 private:
  [[nodiscard]] std::vector<Tick> linear_ticks(int target) const;
  [[nodiscard]] std::vector<Tick> logarithmic_ticks() const;

  Scale scale_;
  double low_;
  double high_;
};

/// Step of 1, 2 or 5 times a power of ten that divides `range` into about `target` parts.
double nice_step(double range, int target);

}  // namespace softgrain::report
