#include "microsim/particles/scene_cell.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/core/error.h"

namespace softgrain {

namespace {

/// The box on the first line of the file with the particles.
Vec3 size_in_file(const SceneTable& t, const SceneBodies& bodies) {
  if (bodies.many_file.empty()) t.reject("size", "\"file\" needs [particles] file, whose first line gives the box");
  for (int k = 0; k < 3; ++k)
    if (!(bodies.many_box[k] > 0.0))
      throw BadInput(bodies.many_file + ":1: Lx Ly Lz must be above 0 for a cell with size = \"file\"");
  return bodies.many_box;
}

Vec3 read_size(const SceneTable& t, const SceneBodies& bodies) {
  if (t.is_text("size")) {
    (void)t.choice("size", {"file"});
    return size_in_file(t, bodies);
  }
  const Vec3 size = t.vector3("size", Unit::length);
  for (int k = 0; k < 3; ++k)
    if (!(size[k] > 0.0)) t.reject("size", "every component must be above 0");
  return size;
}

}  // namespace

Cell<3> read_cell(const SceneTable& root, const SceneBodies& bodies) {
  if (!root.has("cell")) return open_cell<3>();
  const SceneTable t = root.table("cell");
  const Vec3 size = read_size(t, bodies);
  const std::vector<bool> periodic = t.flags("periodic");
  if (periodic.size() != 3) t.reject("periodic", "must have three flags");
  Cell<3> cell = box_cell<3>(size, {periodic[0], periodic[1], periodic[2]});
  const double rate = t.number("shear_rate", Unit::frequency, Range::any(), 0.0);
  if (rate != 0.0 && !(periodic[0] && periodic[1]))
    t.reject("shear_rate", "needs a cell that is periodic along x and y");
  cell.velocity_gradient[0][1] = rate;
  return cell;
}

void require_wide_cell(const SceneTable& root, const Particles<3>& p, const Cell<3>& cell) {
  if (!cell.any_periodic()) return;
  double largest = 0.0;
  for (Slot i = 0; i < p.grains; ++i) largest = std::max(largest, p.sphere[static_cast<std::size_t>(i)].r);
  // Shear does not bring images nearer: beyond half an edge the cell is replaced by the one that leans the other way.
  for (int k = 0; k < 3; ++k) {
    if (!cell.periodic[static_cast<std::size_t>(k)]) continue;
    const double width = cell.edges[k][k];
    if (width >= 4.0 * largest) continue;
    root.table("cell").reject("size", "the periodic axis " + std::string(1, "xyz"[k]) + " is " + std::to_string(width) +
                                          " m wide; allowed: at least " + std::to_string(4.0 * largest) +
                                          " m, two diameters of the largest particle");
  }
}

}  // namespace softgrain
