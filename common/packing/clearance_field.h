// Distance from a point to the nearest surface of many spheres and of the domain's wall.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/packing/void_filling.h"

namespace softgrain {

/// One surface seen from a point x.
struct NearSurface {
  double clearance = 0.0;  ///< distance to it; negative inside a sphere, outside the domain
  Vec3 away{};             ///< unit: the gradient of the clearance
};

/// Spheres in cells, each listed wherever it may be the nearest surface within `reach`. Clearances are exact up to
/// `reach`, beyond it they are only known to exceed it. In a periodic cell a place stands for all its images.
class ClearanceField {
 public:
  ClearanceField(const std::vector<PackedSphere>& spheres, const VoidDomain& domain, double reach);

  void add(const PackedSphere& sphere);
  /// Makes the cells smaller: clearances above `reach` no longer matter. Ends what was exact beyond it.
  void set_reach(double reach);
  [[nodiscard]] double reach() const { return reach_; }

  /// The place in a periodic cell that x is an image of; x itself otherwise.
  [[nodiscard]] Vec3 home(Vec3 x) const;

  /// Radius of the largest sphere around a place, cut at reach(); negative where it lies in a sphere or outside.
  [[nodiscard]] double clearance(const Vec3& place) const;
  /// All surfaces within `most` of a place, nearest first.
  void near(const Vec3& place, double most, std::vector<NearSurface>& out) const;

 private:
  [[nodiscard]] int cell(double x, int axis) const;
  [[nodiscard]] std::size_t index(int a, int b, int c) const {
    return (static_cast<std::size_t>(a) * static_cast<std::size_t>(cells_[1]) + static_cast<std::size_t>(b)) *
               static_cast<std::size_t>(cells_[2]) +
           static_cast<std::size_t>(c);
  }
  [[nodiscard]] const std::vector<std::int32_t>& listed(const Vec3& x) const {
    return log_lists_[index(cell(x[0], 0), cell(x[1], 1), cell(x[2], 2))];
  }
  void list(std::int32_t sphere);
  void append(const PackedSphere& sphere);
  void append_images(const PackedSphere& sphere, double far);
  void append_walls(const Vec3& x, double most, std::vector<NearSurface>& out) const;
  [[nodiscard]] double wall_clearance(const Vec3& x) const;

  std::vector<PackedSphere> spheres_;  ///< spheres; in a periodic cell with those images that are near it
  VoidDomain domain_;
  double reach_ = 0.0;
  std::array<int, 3> cells_{1, 1, 1};
  std::vector<std::vector<std::int32_t>> log_lists_;
};

// From a point in a void to the middle of it, or to where a smaller sphere rests against its walls.

/// Climbs the clearance from x to a local maximum: the centre and radius of a sphere that touches its neighbours from
/// all sides. The radius is the clearance there, cut at the field's reach.
PackedSphere climb(const ClearanceField& field, const Vec3& x);

/// Moves a sphere of radius r, which fits in at x, to a place near by where it touches up to three surfaces. The result
/// fits in as x did.
Vec3 settle(const ClearanceField& field, const Vec3& x, double r);

}  // namespace softgrain
