// Spheres for the voids between placed ones, largest hole first: soft particles between the grains of a decade.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "common/core/vec.h"

namespace softgrain {

struct PackedSphere {
  Vec3 x{};
  double r = 0.0;
};

/// Where spheres may lie: inside a box with corners `low` and `high`, inside a sphere, or anywhere in a periodic cell
/// with these corners, between all images of the others. SI units, or any other.
struct VoidDomain {
  enum class Shape { box, sphere, cell };
  Shape shape = Shape::box;
  Vec3 low{};  ///< lower corner of the box around the domain, for every shape
  Vec3 high{};

  static VoidDomain box(const Vec3& low, const Vec3& high) { return {Shape::box, low, high}; }
  static VoidDomain cell(const Vec3& low, const Vec3& high) { return {Shape::cell, low, high}; }
  static VoidDomain unit_sphere() { return {Shape::sphere, {{-1.0, -1.0, -1.0}}, {{1.0, 1.0, 1.0}}}; }
};

struct VoidFillingOptions {
  double r_max = std::numeric_limits<double>::infinity();   ///< a larger hole gets a sphere of this radius
  double r_min = 0.0;                                       ///< > 0; smaller holes stay empty
  double volume = std::numeric_limits<double>::infinity();  ///< volume to add; the last sphere may exceed it
  std::int64_t count = std::numeric_limits<std::int64_t>::max();
  double tolerance = 1e-2;  ///< a hole counts as the largest when no other is larger by more than this share
};

struct VoidFilling {
  std::vector<PackedSphere> added;  ///< spheres in the order of placement: radii do not grow
  double volume = 0.0;              ///< volume of the added spheres
  double next_hole = 0.0;  ///< bound on the radius that still fits: below r_min when the holes were what ended it
};

/// Adds spheres one by one at the largest hole, each as large as fits: it touches its neighbours there (four of them,
/// or as many as r_max lets it reach). No overlap beyond rounding, nothing outside the domain (of a cell: centres).
/// Depends on its arguments alone: no random numbers. Throws InputError when r_min is not positive or exceeds r_max, or
/// the domain is empty.
VoidFilling fill_voids(const std::vector<PackedSphere>& placed, const VoidDomain& domain,
                       const VoidFillingOptions& options);

/// The largest sphere that fits anywhere (radius 0 when none of r_min or more does).
PackedSphere largest_void(const std::vector<PackedSphere>& placed, const VoidDomain& domain, double r_min,
                          double tolerance = 1e-2);

}  // namespace softgrain
