// A tabulated function that never overshoots its table: Steffen's monotone cubic [Steffen 1990, A&A 239, 443], straight
// between two points, constant with one. Part of the contact laws, and like them free of any library; the tests hold it
// to GSL's gsl_interp_steffen.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

namespace softgrain {

/// y(x) through given points, monotone wherever they are; outside the table the nearest end holds (whoever asks must
/// say so where that matters, see low() and high()).
class MonotoneCurve {
 public:
  MonotoneCurve() = default;
  /// x strictly ascending. Throws std::invalid_argument otherwise.
  MonotoneCurve(std::vector<double> x, std::vector<double> y) : x_(std::move(x)), y_(std::move(y)) {
    if (x_.empty() || x_.size() != y_.size() ||
        std::adjacent_find(x_.begin(), x_.end(), [](double a, double b) { return !(a < b); }) != x_.end())
      throw std::invalid_argument("a curve needs as many values as strictly ascending points");
    for (std::size_t k = 0; k < x_.size() && x_.size() > 1; ++k) slope_.push_back(slope_at(k));
  }

  [[nodiscard]] double value(double x) const {
    if (x_.empty()) throw std::logic_error("value of an empty curve");
    if (x_.size() == 1 || x <= x_.front()) return y_.front();
    if (x >= x_.back()) return y_.back();
    const auto k = static_cast<std::size_t>(std::upper_bound(x_.begin(), x_.end(), x) - x_.begin()) - 1;
    const double h = x_[k + 1] - x_[k];
    const double s = chord(k);
    const double t = x - x_[k];
    const double cubic = (slope_[k] + slope_[k + 1] - 2.0 * s) / h / h;
    const double square = (3.0 * s - 2.0 * slope_[k] - slope_[k + 1]) / h;
    return y_[k] + t * (slope_[k] + t * (square + t * cubic));
  }
  [[nodiscard]] bool empty() const { return x_.empty(); }
  [[nodiscard]] double low() const { return x_.front(); }
  [[nodiscard]] double high() const { return x_.back(); }
  [[nodiscard]] const std::vector<double>& points() const { return x_; }
  [[nodiscard]] const std::vector<double>& values() const { return y_; }

 private:
  [[nodiscard]] double chord(std::size_t k) const { return (y_[k + 1] - y_[k]) / (x_[k + 1] - x_[k]); }

  /// The slope of the parabola through a point and its neighbours, cut so that no interval overshoots; at the ends that
  /// of the chord.
  [[nodiscard]] double slope_at(std::size_t k) const {
    if (k == 0) return chord(0);
    if (k + 1 == x_.size()) return chord(k - 1);
    const double before = chord(k - 1);
    const double after = chord(k);
    const double h0 = x_[k] - x_[k - 1];
    const double h1 = x_[k + 1] - x_[k];
    const double parabola = (before * h1 + after * h0) / (h0 + h1);
    const double least = std::min({std::abs(before), std::abs(after), 0.5 * std::abs(parabola)});
    return (std::copysign(1.0, before) + std::copysign(1.0, after)) * least;
  }

  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<double> slope_;  ///< dy/dx at the points
};

}  // namespace softgrain
