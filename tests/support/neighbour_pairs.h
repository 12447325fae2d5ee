// Cells of every kind, and pairs of grains in an order in which they can be compared.
#pragma once

#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "common/core/cell.h"
#include "common/neighbours/hierarchical_grid.h"

namespace softgrain::test {

enum class Box { open, periodic, half_periodic, sheared };

template <int D>
Cell<D> cell_of(Box box, double size) {
  Vec<D> edges;
  for (double& e : edges.v) e = size;
  std::array<bool, D> periodic{};
  if (box != Box::open) periodic.fill(true);
  if (box == Box::half_periodic) periodic[D - 1] = false;
  Cell<D> cell = box_cell<D>(edges, periodic);
  if (box == Box::sheared)
    for (int c = 1; c < D; ++c)
      for (int r = 0; r < c; ++r) cell.edges[r][c] = size * (r == 0 ? 0.47 : -0.31);
  return cell;
}

using Found = std::vector<std::tuple<Slot, Slot, std::int32_t>>;

inline Found sorted(const std::vector<CandidatePair>& pairs) {
  Found out;
  for (const CandidatePair& c : pairs) out.emplace_back(c.i, c.j, c.image);
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace softgrain::test
