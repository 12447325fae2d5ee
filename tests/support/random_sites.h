// Spheres at random places in a cell, for cells of space and the matter in them.
#pragma once

#include <cmath>
#include <vector>

#include "common/core/cell.h"
#include "common/core/particles.h"
#include "common/core/random.h"

namespace softgrain {

/// Upper triangular edges, periodic along every axis.
inline Cell<3> sheared_cell(const Vec3& size, double xy, double xz, double yz) {
  Cell<3> cell = box_cell<3>(size, {true, true, true});
  cell.edges[0][1] = xy;
  cell.edges[0][2] = xz;
  cell.edges[1][2] = yz;
  return cell;
}

/// The same place within the cell.
inline Vec3 wrapped(const Vec3& x, const Cell<3>& cell) {
  Vec3 s = cell.fractional(x);
  for (int k = 0; k < 3; ++k) s[k] -= std::floor(s[k]);
  return cell.edges * s;
}

/// Radii log-uniform between r_min and r_max. No two centres nearer than `apart` of the spacing.
inline std::vector<Sphere<3>> random_sites(const Cell<3>& cell, int n, double r_min, double r_max, std::uint64_t index,
                                           double apart = 0.3) {
  RandomStream random(11, RandomPurpose::test, index);
  const double least = apart * std::cbrt(cell.volume() / n);
  std::vector<Sphere<3>> out;
  while (static_cast<int>(out.size()) < n) {
    Sphere<3> one;
    Vec3 s;
    for (int k = 0; k < 3; ++k) s[k] = random.uniform();
    one.x = cell.edges * s;
    one.r = r_min * std::pow(r_max / r_min, random.uniform());
    bool free = true;
    for (const auto& other : out)
      for (int image = 0; image < image_count<3>(); ++image)
        free = free && norm(other.x + cell.image_shift(image) - one.x) > least;
    if (free) out.push_back(one);
  }
  return out;
}

}  // namespace softgrain
