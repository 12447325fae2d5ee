// Clouds of grains in cells of any shape, drawn from a seed that rapidcheck gives.
#pragma once

#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "common/core/random.h"
#include "common/neighbours/hierarchical_grid.h"
#include "common/neighbours/verlet_list.h"

namespace softgrain::test {

/// What a cloud looks like. Lengths in units of the largest radius.
struct CloudShape {
  int grains = 2;
  double decades = 0.0;    ///< log10 of the ratio of radii, 0 to 3
  int periodic = 0;        ///< bit k: along axis k
  double room = 1.0;       ///< edges over the least that is allowed
  double tilt[3] = {};     ///< xy, xz, yz over the edge they lean along, -0.5 to 0.5
  std::uint64_t seed = 0;  ///< of places and radii
};

inline double share() { return *rc::gen::inRange(0, 1001) * 1e-3; }

/// Drawn by rapidcheck; smaller and simpler clouds are tried first.
inline CloudShape any_cloud(int most_grains) {
  CloudShape c;
  c.grains = *rc::gen::inRange(2, most_grains);
  c.decades = 3.0 * share();
  c.periodic = *rc::gen::inRange(0, 8);
  c.room = 1.0 + 1.5 * share();
  for (double& t : c.tilt) t = share() - 0.5;
  c.seed = *rc::gen::arbitrary<std::uint32_t>();
  return c;
}

/// Images of a grain stay two diameters of the largest one, with its margin, apart.
template <int D>
Cell<D> cell_of(const CloudShape& c) {
  constexpr double kLeast = 4.6;
  Cell<D> cell;
  for (int k = 0; k < D; ++k) {
    cell.edges[k][k] = kLeast * c.room * (1.0 + 0.2 * k);
    cell.periodic[static_cast<std::size_t>(k)] = (c.periodic >> k) % 2 != 0;
  }
  int n = 0;
  for (int column = 1; column < D; ++column)
    for (int row = 0; row < column; ++row, ++n)
      if (cell.periodic[static_cast<std::size_t>(row)] && cell.periodic[static_cast<std::size_t>(column)])
        cell.edges[row][column] = c.tilt[n] * cell.edges[row][row];
  return cell;
}

/// One grain of radius 1, the others log-uniform below it, anywhere in the cell.
template <int D>
void add_cloud(const CloudShape& c, const Cell<D>& cell, Particles<D>& p) {
  RandomStream random(c.seed, RandomPurpose::test, 0);
  for (int k = 0; k < c.grains; ++k) {
    Vec<D> fraction;
    for (double& f : fraction.v) f = random.uniform();
    NewBody<D> body;
    body.x = cell.edges * fraction;
    body.r = k == 0 ? 1.0 : std::pow(10.0, -c.decades * random.uniform());
    body.mass = body.r * body.r * body.r;
    body.inertia = 0.4 * body.mass * body.r * body.r;
    add_grain(p, body);
  }
}

using Pairs = std::vector<std::tuple<Slot, Slot, std::int32_t>>;

inline Pairs as_tuples(const std::vector<CandidatePair>& pairs) {
  Pairs out;
  for (const CandidatePair& c : pairs) out.emplace_back(c.i, c.j, c.image);
  return out;
}

/// Everything moves by up to `step` of its own margin, in a direction of its own.
template <int D>
void shake(System<D>& s, double step, RandomStream& random) {
  for (Slot i = 0; i < s.particles.grains; ++i) {
    const auto u = static_cast<std::size_t>(i);
    for (double& x : s.particles.sphere[u].x.v) x += step * s.neighbours.skin[u] * (2.0 * random.uniform() - 1.0);
  }
}

}  // namespace softgrain::test
