// Small fixed-size vectors of the kernels. Dimension is a template argument; rotations are a vector in 3D, a number in
// 2D.
#pragma once  // SPDX-License-Identifier: BSD-3-Clause

#include <array>
#include <cmath>
#include <cstddef>

namespace softgrain {

/// T is double, or several of them side by side (the lanes of a vectorised loop).
template <int D, class T = double>
struct Vec {
  std::array<T, D> v{};

  constexpr T& operator[](int k) { return v[static_cast<std::size_t>(k)]; }
  constexpr T operator[](int k) const { return v[static_cast<std::size_t>(k)]; }

  constexpr Vec& operator+=(const Vec& o) {
    for (int k = 0; k < D; ++k) (*this)[k] += o[k];
    return *this;
  }
  constexpr Vec& operator-=(const Vec& o) {
    for (int k = 0; k < D; ++k) (*this)[k] -= o[k];
    return *this;
  }
  constexpr Vec& operator*=(T s) {
    for (int k = 0; k < D; ++k) (*this)[k] *= s;
    return *this;
  }
  friend constexpr Vec operator+(Vec a, const Vec& b) { return a += b; }
  friend constexpr Vec operator-(Vec a, const Vec& b) { return a -= b; }
  friend constexpr Vec operator-(Vec a) { return a *= T(-1.0); }
  friend constexpr Vec operator*(Vec a, T s) { return a *= s; }
  friend constexpr Vec operator*(T s, Vec a) { return a *= s; }
  friend constexpr bool operator==(const Vec&, const Vec&) = default;
};

using Vec2 = Vec<2>;
using Vec3 = Vec<3>;

template <int D, class T>
constexpr T dot(const Vec<D, T>& a, const Vec<D, T>& b) {
  T s = a[0] * b[0];
  for (int k = 1; k < D; ++k) s += a[k] * b[k];
  return s;
}

template <int D, class T>
constexpr T norm2(const Vec<D, T>& a) {
  return dot(a, a);
}

template <int D>
double norm(const Vec<D>& a) {
  return std::sqrt(norm2(a));
}

/// A vector as it lies in the big arrays: three numbers take an aligned 32-byte record, one load of the contact loop.
template <int D>
struct alignas(D == 3 ? 32 : 8 * D) Stored : Vec<D> {
  constexpr Stored() = default;
  constexpr Stored(const Vec<D>& a) : Vec<D>(a) {}  // NOLINT(google-explicit-constructor): the same thing elsewhere
};

/// Angular quantity: spin, torque. A vector in 3D, one number in 2D.
template <int D>
constexpr int kRot = D == 3 ? 3 : 1;
template <int D, class T = double>
using Rot = Vec<kRot<D>, T>;
template <int D>
using StoredRot = Stored<kRot<D>>;

/// arm x force: the moment.
template <class T>
constexpr Vec<3, T> cross(const Vec<3, T>& a, const Vec<3, T>& b) {
  return {{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}
template <class T>
constexpr Vec<1, T> cross(const Vec<2, T>& a, const Vec<2, T>& b) {
  return {{a[0] * b[1] - a[1] * b[0]}};
}

/// spin x arm: the velocity of a point of a turning body.
template <class T>
constexpr Vec<2, T> cross(const Vec<1, T>& w, const Vec<2, T>& a) {
  return {{-w[0] * a[1], w[0] * a[0]}};
}

/// Rotates `a` by `angle` [rad] about the unit vector `axis` (Rodrigues).
inline Vec3 rotate(const Vec3& a, const Vec3& axis, double angle) {
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  return a * c + cross(axis, a) * s + axis * (dot(axis, a) * (1.0 - c));
}

/// A vector of space; what is flat has z = 0.
template <int D>
Vec3 in_space(const Vec<D>& a) {
  Vec3 out{};
  for (int k = 0; k < D; ++k) out[k] = a[k];
  return out;
}

}  // namespace softgrain
