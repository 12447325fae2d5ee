// Small packs of grains between six planes for tests of the least-work solver.
#pragma once

#include <limits>
#include <vector>

#include "common/core/random.h"
#include "common/statics/least_work.h"

namespace softgrain::test {

inline PackWall plane(int axis, bool high, double at, double friction) {
  PackWall w;
  w.point[axis] = at;
  w.normal[axis] = high ? -1.0 : 1.0;
  w.youngs_modulus = std::numeric_limits<double>::infinity();
  w.friction = friction;
  return w;
}

/// Walls of a box [0, size], order -x +x -y +y -z +z.
inline void add_box(GrainPack& pack, const Vec3& size, double friction) {
  for (int k = 0; k < 3; ++k) {
    pack.walls.push_back(plane(k, false, 0.0, friction));
    pack.walls.push_back(plane(k, true, size[k], friction));
  }
}

inline void add_grain(GrainPack& pack, const Vec3& x, double radius, double youngs_modulus = 70e9, double nu = 0.2) {
  pack.position.push_back(x);
  pack.radius.push_back(radius);
  pack.youngs_modulus.push_back(youngs_modulus);
  pack.poisson_ratio.push_back(nu);
}

/// Moves of the walls for compressive strains of the box, opposite walls symmetric.
inline std::vector<Vec3> squeeze(const GrainPack& pack, const Vec3& strain) {
  std::vector<Vec3> moves(6);
  for (int k = 0; k < 3; ++k) {
    const auto low = static_cast<std::size_t>(2 * k);
    const double half = 0.5 * strain[k] * (pack.walls[low + 1].point[k] - pack.walls[low].point[k]);
    moves[low][k] = half;
    moves[low + 1][k] = -half;
  }
  return moves;
}

/// n^3 grains of radii 0.7..1.3 mm on a shaken cubic lattice, compacted without friction until the contacts carry about
/// 1e-4 of E; then every contact gets `friction`.
inline GrainPack random_pack(int n, double friction, std::uint64_t seed = 5) {
  GrainPack pack;
  RandomStream random(seed, RandomPurpose::test, 0);
  constexpr double kSpacing = 2.7e-3;
  for (int k = 0; k < n * n * n; ++k) {
    Vec3 x{{k % n + 0.5, k / n % n + 0.5, static_cast<double>(k / (n * n)) + 0.5}};
    for (int a = 0; a < 3; ++a) x[a] += 0.02 * (random.uniform() - 0.5);
    add_grain(pack, x * kSpacing, (0.7 + 0.6 * random.uniform()) * 1e-3);
  }
  add_box(pack, Vec3{{1.0, 1.0, 1.0}} * (n * kSpacing), 0.0);
  LeastWorkOptions loose;
  loose.residual_tolerance = 1e-2;
  loose.force_floor = 1e-5;
  for (int k = 0; k < 200; ++k) {
    double force = 0.0;
    for (const PackContact& c : pack.contacts) force += c.normal_force;
    if (force > 2e-4 * 70e9 * 1e-6 * pack.grains()) break;
    advance(pack, squeeze(pack, {{4e-3, 4e-3, 4e-3}}), loose);
  }
  advance(pack, std::vector<Vec3>(6), {});
  pack.friction = friction;
  for (PackWall& w : pack.walls) w.friction = friction;
  return pack;
}

}  // namespace softgrain::test
