// Where cells are: a periodic cell, or the room between six planes.
#pragma once

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include "common/tessellation/radical_cells.h"

namespace softgrain {

class CellRoom {
 public:
  // Both are rooms as they stand.
  CellRoom(const Cell<3>& cell) : where_(cell) {}       // NOLINT(google-explicit-constructor)
  CellRoom(const PlaneBox& planes) : where_(planes) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool periodic() const { return std::holds_alternative<Cell<3>>(where_); }
  [[nodiscard]] const Cell<3>& cell() const { return std::get<Cell<3>>(where_); }
  [[nodiscard]] const PlaneBox& planes() const { return std::get<PlaneBox>(where_); }
  [[nodiscard]] double volume() const;
  [[nodiscard]] Vec3 low() const;  ///< corners; of a periodic cell the origin and the sum of its edges
  [[nodiscard]] Vec3 high() const;
  /// Where strains move nothing: the centre of the planes, the origin of a periodic cell.
  [[nodiscard]] Vec3 centre() const;

  /// Lengths along the axes times `factor`, about the centre.
  void stretch(const Vec3& factor);

  /// Sites that left a periodic cell come back into it; `periods` counts the periods they were moved back by. Throws
  /// InputError for a site without a place.
  void bring_home(std::vector<Sphere<3>>& sites, std::vector<std::array<std::int32_t, 3>>& periods) const;

  /// Whether all sites are inside the room; only between planes may a site be outside.
  [[nodiscard]] bool holds(const std::vector<Sphere<3>>& sites) const;

  [[nodiscard]] RadicalCells cells_of(const std::vector<Sphere<3>>& sites) const;

 private:
  std::variant<Cell<3>, PlaneBox> where_;
};

}  // namespace softgrain
