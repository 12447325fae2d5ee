// Small fixed-size vectors of the kernels. Dimension is a template argument; rotations are a vector in 3D, a number in
// 2D.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace softgrain {

template <int D>
struct Vec {
  std::array<double, D> v{};

  constexpr double& operator[](int k) { return v[static_cast<std::size_t>(k)]; }
  constexpr double operator[](int k) const { return v[static_cast<std::size_t>(k)]; }

  constexpr Vec& operator+=(const Vec& o) {
    for (int k = 0; k < D; ++k) (*this)[k] += o[k];
    return *this;
  }
  constexpr Vec& operator-=(const Vec& o) {
    for (int k = 0; k < D; ++k) (*this)[k] -= o[k];
    return *this;
  }
  constexpr Vec& operator*=(double s) {
    for (int k = 0; k < D; ++k) (*this)[k] *= s;
    return *this;
  }
  friend constexpr Vec operator+(Vec a, const Vec& b) { return a += b; }
  friend constexpr Vec operator-(Vec a, const Vec& b) { return a -= b; }
  friend constexpr Vec operator-(Vec a) { return a *= -1.0; }
  friend constexpr Vec operator*(Vec a, double s) { return a *= s; }
  friend constexpr Vec operator*(double s, Vec a) { return a *= s; }
  friend constexpr bool operator==(const Vec&, const Vec&) = default;
};

using Vec2 = Vec<2>;
using Vec3 = Vec<3>;

template <int D>
constexpr double dot(const Vec<D>& a, const Vec<D>& b) {
  double s = a[0] * b[0];
  for (int k = 1; k < D; ++k) s += a[k] * b[k];
  return s;
}

template <int D>
constexpr double norm2(const Vec<D>& a) {
  return dot(a, a);
}

template <int D>
double norm(const Vec<D>& a) {
  return std::sqrt(norm2(a));
}

/// Angular quantity: spin, torque. A vector in 3D, one number in 2D.
template <int D>
struct RotationOf;
template <>
struct RotationOf<3> {
  using type = Vec<3>;
};
template <>
struct RotationOf<2> {
  using type = Vec<1>;
};
template <int D>
using Rot = typename RotationOf<D>::type;

/// arm x force: the moment.
constexpr Vec<3> cross(const Vec<3>& a, const Vec<3>& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}
constexpr Vec<1> cross(const Vec<2>& a, const Vec<2>& b) { return {{a[0] * b[1] - a[1] * b[0]}}; }

/// spin x arm: the velocity of a point of a turning body.
constexpr Vec<2> cross(const Vec<1>& w, const Vec<2>& a) { return {{-w[0] * a[1], w[0] * a[0]}}; }

/// Rotates `a` by `angle` [rad] about the unit vector `axis` (Rodrigues).
inline Vec3 rotate(const Vec3& a, const Vec3& axis, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return a * c + cross(axis, a) * s + axis * (dot(axis, a) * (1.0 - c));
}

}  // namespace softgrain
