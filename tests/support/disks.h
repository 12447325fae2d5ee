// Disks put down by hand, for tests of powders.
#pragma once

#include <vector>

#include "microsim/powder/powder_start.h"

namespace softgrain::test {

struct HandDisk {
  Vec<2> x{};
  double r = 0.5;
};

/// At rest under the law of `spec`, in a square periodic cell; `edge` 0: in free space.
inline System<2> disks_by_hand(const PowderSpec& spec, const std::vector<HandDisk>& disks, double edge = 0.0) {
  System<2> s;
  s.materials = {{"disk", 1.0, 1.0, 0.3, false}};
  s.laws = LawSet(1);
  s.laws.set(0, 0, powder_law(spec));
  if (edge > 0.0) s.cell = box_cell<2>({{edge, edge}}, {true, true});
  for (const HandDisk& disk : disks) {
    NewBody<2> body;
    body.x = disk.x;
    body.r = disk.r;
    body.mass = 4.0 * disk.r * disk.r;
    body.inertia = 0.5 * body.mass * disk.r * disk.r;
    add_grain(s.particles, body);
  }
  return s;
}

}  // namespace softgrain::test
