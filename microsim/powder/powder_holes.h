// Holes of a powder: connected parts of the void on a periodic mesh, and their sizes [CP 3.5].
#pragma once

#include <cstdint>
#include <vector>

#include "microsim/powder/powder_mesh.h"

namespace softgrain {

/// A connected part of the void. Cells are connected through their edges (4 neighbours), the solid then through corners
/// too (8), so that a closed chain of touching disks closes a hole.
struct Hole {
  double area = 0.0;        ///< [a^2]
  Vec<2> centre{};          ///< centre of mass, unwrapped across the period, then folded into it [a]
  double radius = 0.0;      ///< R_H = sqrt(2 <|r - r_c|^2>) [a]: R for a disk of radius R; NaN when it percolates
  bool percolates = false;  ///< connected with an image of itself: it has no centre and no radius
};

struct PowderHoles {
  std::vector<Hole> holes;       ///< largest area first
  std::int64_t count = 0;        ///< holes of at least the asked area
  std::int64_t fragments = 0;    ///< smaller ones: ends of cusps that the mesh cuts off
  double void_fraction = 0.0;    ///< area of all holes over that of the cell
  double largest_radius = 0.0;   ///< NaN when a hole percolates
  double largest_share = 0.0;    ///< share of the void in the hole of the largest area
  double mean_radius = 0.0;      ///< mean of R_H weighted by A_H over all holes [a]; NaN when a hole percolates
  std::int64_t percolating = 0;  ///< holes that percolate
};

/// Gaps below about a cell between disks that do not interact count as closed or open as the mesh falls: in dense
/// packs of 200 disks the mean radius at a/100 is 2 % below its value at a/200.
/// Finds the holes by joining runs of void cells, row by row: time in proportion to the cells. `smallest_area` [a^2]
/// only divides the number of holes into holes and fragments.
PowderHoles powder_holes(const PowderMesh& mesh, double smallest_area = 0.0);

/// Area between three touching disks of radius r: (sqrt 3 - pi/2) r^2, the least that disks of radius >= r enclose.
double smallest_hole_area(double r);

}  // namespace softgrain
