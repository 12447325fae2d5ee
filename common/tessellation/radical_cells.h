// Radical (power) Voronoi cells of spheres: the points whose power |x - x_i|^2 - r_i^2 is smallest for sphere i
// [Gellatly and Finney 1982, J. Non-Cryst. Solids 50, 313; cells cut by voro++, Rycroft 2009, Chaos 19, 041111].
#pragma once

#include <cstdint>
#include <vector>

#include "common/core/cell.h"
#include "common/core/particles.h"

namespace softgrain {

/// Where the cells of two sites meet, once for each pair and image. `normal = separation/distance` is perpendicular to
/// it; with r_i = r_j it halves the way between the sites.
struct CellFace {
  std::int32_t i = 0;
  std::int32_t j = 0;  ///< i < j; or i = j, then image > home_image<3>()
  int image = 0;       ///< periodic image of j as i sees it, numbered as in Cell::image_shift
  double area = 0.0;   ///< [m^2]
  double distance = 0.0;
  Vec3 centroid;    ///< beside x_i, as i sees the face; beside x_j it lies at centroid - Cell::image_shift(image)
  Vec3 separation;  ///< x_j + shift - x_i [m]

  friend bool operator==(const CellFace&, const CellFace&) = default;
};

/// Where the cell of a site ends at a plane of the box.
struct WallFace {
  std::int32_t site = 0;
  int plane = 0;  ///< 2 axis + (0: the lower, 1: the upper one)
  double area = 0.0;
  Vec3 centroid;

  friend bool operator==(const WallFace&, const WallFace&) = default;
};

struct RadicalCells {
  std::vector<double> volume;      ///< volume of each cell [m^3]; 0 where larger neighbours leave it nothing (no faces)
  std::vector<CellFace> faces;     ///< ordered by (i, j, image)
  std::vector<WallFace> at_walls;  ///< ordered by (site, plane); empty in a periodic cell
};

/// Room between six planes; both corners belong to it.
struct PlaneBox {
  Vec3 low;
  Vec3 high;

  [[nodiscard]] double volume() const { return (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]); }
};

/// Cells in a cell that is periodic along every axis; centres lie within it (fractional coordinates in [0, 1], up to
/// 1e-9). Faces of less than 1e-10 of the squared spacing (V/N)^(2/3) are left out. The same bits for any number of
/// threads.
/// Throws InputError for no sites, values that are not finite, radii below 0, centres outside, centres closer than 1e-9
/// spacings, a cell without volume or with an open axis; UnusableResult where a cell sees an image beyond the
/// neighbouring ones (few sites in a strongly sheared or very flat cell), and where the volumes do not add up to the
/// cell within 1e-9, or the two sides of a face do not agree.
RadicalCells radical_cells(const std::vector<Sphere<3>>& sites, const Cell<3>& cell);

/// Radical cells between planes, otherwise as in a periodic cell.
RadicalCells radical_cells(const std::vector<Sphere<3>>& sites, const PlaneBox& box);

}  // namespace softgrain
