// The cell: a box or parallelepiped, open or periodic per axis, that may deform with a steady velocity gradient.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "common/core/vec.h"

namespace softgrain {

/// D x D matrix, row-major.
template <int D>
struct Matrix {
  std::array<Vec<D>, D> row{};

  Vec<D>& operator[](int k) { return row[static_cast<std::size_t>(k)]; }
  const Vec<D>& operator[](int k) const { return row[static_cast<std::size_t>(k)]; }
  friend bool operator==(const Matrix&, const Matrix&) = default;
};

template <int D>
Vec<D> operator*(const Matrix<D>& m, const Vec<D>& a) {
  Vec<D> out;
  for (int k = 0; k < D; ++k) out[k] = dot(m[k], a);
  return out;
}

/// Images of a neighbour are numbered -1, 0, 1 per axis: index = sum (n_k + 1) 3^k.
template <int D>
constexpr int image_count() {
  int n = 1;
  for (int k = 0; k < D; ++k) n *= 3;
  return n;
}
template <int D>
constexpr int home_image() {
  return image_count<D>() / 2;
}

/// `edges` is upper triangular: column k is the k-th edge vector (so edge 0 lies along x). Lengths in m, rate in 1/s.
template <int D>
struct Cell {
  Matrix<D> edges{};               ///< unused along open axes
  Matrix<D> velocity_gradient{};   ///< d(edges)/dt = velocity_gradient * edges
  std::array<bool, D> periodic{};  ///< open by default

  [[nodiscard]] bool any_periodic() const {
    bool any = false;
    for (const bool p : periodic) any = any || p;
    return any;
  }

  [[nodiscard]] Vec<D> image_shift(int image) const {
    Vec<D> steps;
    for (int k = 0; k < D; ++k) {
      steps[k] = image % 3 - 1;
      image /= 3;
    }
    return edges * steps;
  }

  /// Number of the image whose place x + image_shift() is nearest to `from`, of bodies that are at most one period
  /// apart.
  [[nodiscard]] int image_near(const Vec<D>& from, const Vec<D>& x) const {
    if (!any_periodic()) return home_image<D>();
    const Vec<D> s = fractional(from - x);
    int image = 0;
    for (int k = D - 1; k >= 0; --k) {
      const bool repeats = periodic[static_cast<std::size_t>(k)];
      image = 3 * image + 1 + (repeats ? static_cast<int>(std::clamp(std::round(s[k]), -1.0, 1.0)) : 0);
    }
    return image;
  }

  /// Coordinates in units of the edges (open axes: metres, edge length 1 assumed by set_open).
  [[nodiscard]] Vec<D> fractional(Vec<D> x) const {
    Vec<D> s;
    for (int k = D - 1; k >= 0; --k) {
      double rest = x[k];
      for (int l = k + 1; l < D; ++l) rest -= edges[k][l] * s[l];
      s[k] = rest / edges[k][k];
    }
    return s;
  }

  [[nodiscard]] double volume() const {
    double v = 1.0;
    for (int k = 0; k < D; ++k) v *= edges[k][k];
    return v;
  }

  /// Stretches space along each axis by a factor: every edge vector has a component there, of a cell that was sheared.
  void stretch(const Vec<D>& factor) {
    for (int k = 0; k < D; ++k) edges[k] *= factor[k];
  }

  /// Moves the edges by one explicit step of their velocity gradient.
  void advance(double dt) {
    Matrix<D> next = edges;
    for (int r = 0; r < D; ++r)
      for (int c = 0; c < D; ++c)
        for (int k = 0; k < D; ++k) next[r][c] += dt * velocity_gradient[r][k] * edges[k][c];
    edges = next;
  }
};

/// A cell that is open everywhere.
template <int D>
Cell<D> open_cell() {
  Cell<D> cell;
  for (int k = 0; k < D; ++k) cell.edges[k][k] = 1.0;
  return cell;
}

/// A rectangular cell.
template <int D>
Cell<D> box_cell(const Vec<D>& size, const std::array<bool, D>& periodic) {
  Cell<D> cell;
  for (int k = 0; k < D; ++k) cell.edges[k][k] = size[k];
  cell.periodic = periodic;
  return cell;
}

/// What each axis of a box is held by.
struct BoxControl {
  std::array<bool, 3> by_stress{};  ///< else its length stays
  Vec3 stress{};                    ///< stress on the axes held by stress, compression positive [Pa]
  bool isotropic = false;           ///< all axes strain alike, by the mean of their stresses
  double tolerance = 1e-3;          ///< tolerance of the stress, over the largest one asked for
  double least_stress = 0.0;        ///< lower limit of that largest stress in the tolerance [Pa]
  double largest_strain = 2e-3;     ///< per pass
  double farthest = HUGE_VAL;       ///< logarithmic strain in all at which the stress is given up as out of reach

  /// Whether an axis is held by no stress at all.
  [[nodiscard]] bool free(int axis) const { return by_stress[static_cast<std::size_t>(axis)] && stress[axis] == 0.0; }
};

}  // namespace softgrain
