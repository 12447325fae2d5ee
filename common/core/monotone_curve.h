// A tabulated function that never overshoots its table: Steffen's monotone cubic (GSL), straight between two points,
// constant with one.
#pragma once

#include <memory>
#include <vector>

namespace softgrain {

/// y(x) through given points, monotone wherever they are; outside the table the nearest end holds (whoever asks must
/// say so where that matters, see low() and high()).
class MonotoneCurve {
 public:
  MonotoneCurve() = default;
  /// x strictly ascending. Throws std::invalid_argument otherwise.
  MonotoneCurve(std::vector<double> x, std::vector<double> y);

  [[nodiscard]] double value(double x) const;
  [[nodiscard]] bool empty() const { return x_.empty(); }
  [[nodiscard]] double low() const { return x_.front(); }
  [[nodiscard]] double high() const { return x_.back(); }

 private:
  std::vector<double> x_;
  std::vector<double> y_;
  std::shared_ptr<const void> spline_;  ///< gsl_spline; shared, never changed
};

}  // namespace softgrain
