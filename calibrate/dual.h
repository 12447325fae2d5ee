// Forward automatic differentiation: a number with its gradient over N parameters. Exact to rounding, unlike
// differences.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace softgrain {

/// v + sum_j d_j eps_j with eps_j eps_k = 0.
template <std::size_t N>
struct Dual {
  double v = 0.0;
  std::array<double, N> d{};

  Dual() = default;
  Dual(double value) : v(value) {}  // NOLINT(google-explicit-constructor): constants mix with duals in formulas

  /// The j-th parameter itself.
  static Dual variable(double value, std::size_t j) {
    Dual x(value);
    x.d[j] = 1.0;
    return x;
  }

  /// g(x) with the chain rule: value g, slope dg/dx.
  [[nodiscard]] Dual chain(double g, double slope) const {
    Dual y(g);
    for (std::size_t j = 0; j < N; ++j) y.d[j] = slope * d[j];
    return y;
  }

  friend Dual operator-(const Dual& a) { return a.chain(-a.v, -1.0); }
  friend Dual operator+(const Dual& a, const Dual& b) { return combine(a, 1.0, b, 1.0, a.v + b.v); }
  friend Dual operator-(const Dual& a, const Dual& b) { return combine(a, 1.0, b, -1.0, a.v - b.v); }
  friend Dual operator*(const Dual& a, const Dual& b) { return combine(a, b.v, b, a.v, a.v * b.v); }
  friend Dual operator/(const Dual& a, const Dual& b) {
    return combine(a, 1.0 / b.v, b, -a.v / (b.v * b.v), a.v / b.v);
  }

  friend Dual exp(const Dual& a) { return a.chain(std::exp(a.v), std::exp(a.v)); }
  friend Dual log(const Dual& a) { return a.chain(std::log(a.v), 1.0 / a.v); }
  friend Dual sin(const Dual& a) { return a.chain(std::sin(a.v), std::cos(a.v)); }
  friend Dual cos(const Dual& a) { return a.chain(std::cos(a.v), -std::sin(a.v)); }
  friend Dual atan(const Dual& a) { return a.chain(std::atan(a.v), 1.0 / (1.0 + a.v * a.v)); }
  /// a^b for a > 0.
  friend Dual pow(const Dual& a, const Dual& b) {
    const double p = std::pow(a.v, b.v);
    return combine(a, b.v * std::pow(a.v, b.v - 1.0), b, p * std::log(a.v), p);
  }
  friend bool operator<(const Dual& a, double b) { return a.v < b; }

 private:
  static Dual combine(const Dual& a, double ka, const Dual& b, double kb, double value) {
    Dual y(value);
    for (std::size_t j = 0; j < N; ++j) y.d[j] = ka * a.d[j] + kb * b.d[j];
    return y;
  }
};

}  // namespace softgrain
