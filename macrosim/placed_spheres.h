// Spheres that have found their place, for the question whether another one would overlap any of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/core/random.h"
#include "common/core/vec.h"

namespace softgrain {

/// A grid of cells per octave of radii: the cost of a question depends on what is near, not on how many there are or
/// how far sizes differ. Answers are those of testing all spheres, to the bit.
class PlacedSpheres {
 public:
  /// Spheres with centres in the cube [0, edge]^3 [m]; `radii` of all that will come, in any order. Periodic: the cube
  /// repeats along all axes, and is longer than two spheres that touch.
  PlacedSpheres(double edge, const std::vector<double>& radii, bool periodic = false);

  /// A random place: inside the cube for the whole sphere, periodic anywhere.
  [[nodiscard]] Vec3 place_of(double r, RandomStream& random) const;

  /// Whether |x - x_j| < r + r_j for any sphere j, periodic for any image of it.
  [[nodiscard]] bool collides(const Vec3& x, double r) const;

  void add(const Vec3& x, double r);

 private:
  /// Spheres of radii in (largest/2, largest], cell by cell in linked lists.
  struct Level {
    double largest = 0.0;
    double cells_per_length = 0.0;  ///< [1/m]
    std::int64_t cells = 1;         ///< number of cells per edge
    std::vector<std::int32_t> first;
  };
  struct Placed {
    Vec3 x{};
    double r = 0.0;
    std::int32_t next = -1;  ///< next sphere in the same cell; -1: none
  };

  [[nodiscard]] bool collides(const Level& level, const Vec3& x, double r) const;
  [[nodiscard]] bool collides(const Placed& first, const Vec3& x, double r) const;
  [[nodiscard]] bool collides_in_home(const Vec3& x, double r) const;
  [[nodiscard]] std::int64_t cell_of(const Level& level, double coordinate) const;
  [[nodiscard]] std::int32_t& head(Level& level, const Vec3& x) const;

  double edge_;
  bool periodic_;
  std::vector<Level> levels_;
  std::vector<Placed> spheres_;
};

}  // namespace softgrain
