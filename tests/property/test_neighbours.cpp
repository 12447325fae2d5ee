// The neighbour list against testing all pairs, for any cloud in any cell, at rest and in motion.
#include <gtest/gtest.h>

#include "common/contact/hertz_mindlin.h"
#include "common/neighbours/verlet_list.h"
#include "tests/property/random_cloud.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

template <int D>
void grid_is_all_pairs(const CloudShape& shape) {
  const Cell<D> cell = cell_of<D>(shape);
  Particles<D> p;
  add_cloud(shape, cell, p);
  const std::vector<double> skin = default_skin(p);
  const Pairs grid = as_tuples(candidate_pairs(p, cell, skin));
  Pairs all = as_tuples(candidate_pairs_brute_force(p, cell, skin));
  std::sort(all.begin(), all.end());
  RC_ASSERT(std::is_sorted(grid.begin(), grid.end()));
  RC_ASSERT(std::adjacent_find(grid.begin(), grid.end()) == grid.end());
  RC_ASSERT(grid == all);
}

RC_GTEST_PROP(NeighbourProperty, TheGridFindsWhatAllPairsFind2D, ()) { grid_is_all_pairs<2>(any_cloud(150)); }
RC_GTEST_PROP(NeighbourProperty, TheGridFindsWhatAllPairsFind3D, ()) { grid_is_all_pairs<3>(any_cloud(150)); }

template <int D>
System<D> system_of(const CloudShape& shape) {
  System<D> s;
  s.materials = {{"glass", 2500.0, 1e7, 0.25, false}};
  s.laws = LawSet(1);
  s.laws.set(0, 0, hertz_law(HertzCoefficients::of(s.materials[0], s.materials[0], 0.3, 0.9), false));
  s.cell = cell_of<D>(shape);
  add_cloud(shape, s.cell, s.particles);
  return s;
}

/// Rates of a deforming cell: shear and volume where both axes are periodic.
template <int D>
void set_flow(Cell<D>& cell, double rate, RandomStream& random) {
  for (int r = 0; r < D; ++r)
    for (int c = r; c < D; ++c)
      if (cell.periodic[static_cast<std::size_t>(r)] && cell.periodic[static_cast<std::size_t>(c)])
        cell.velocity_gradient[r][c] = rate * (2.0 * random.uniform() - (c == r ? 0.6 : 1.0));
}

/// Bodies go with the cell.
template <int D>
void flow(System<D>& s, double dt) {
  for (Slot i = 0; i < s.particles.grains; ++i) {
    auto& x = s.particles.sphere[static_cast<std::size_t>(i)].x;
    x += s.cell.velocity_gradient * x * dt;
  }
  s.cell.advance(dt);
}

/// Every touching pair is listed, once, with its image.
template <int D>
void require_complete(const System<D>& s) {
  Pairs listed;
  for (std::size_t c = 0; c < s.contacts.i.size(); ++c)
    listed.emplace_back(s.contacts.i[c], s.contacts.j[c], s.contacts.image[c]);
  RC_ASSERT(std::is_sorted(listed.begin(), listed.end()));
  RC_ASSERT(std::adjacent_find(listed.begin(), listed.end()) == listed.end());
  const std::vector<double> none(static_cast<std::size_t>(s.particles.size()), 0.0);
  for (const auto& touching : as_tuples(candidate_pairs_brute_force(s.particles, s.cell, none)))
    RC_ASSERT(std::binary_search(listed.begin(), listed.end(), touching));
}

template <int D>
void no_contact_is_missed() {
  CloudShape shape = any_cloud(60);
  shape.decades *= 0.6;
  shape.room += 0.4;
  System<D> s = system_of<D>(shape);
  RandomStream random(shape.seed, RandomPurpose::test, 1);
  set_flow(s.cell, share(), random);
  const double step = share();
  rebuild_neighbours(s);
  for (int k = 0; k < 15; ++k) {
    flow(s, 0.01);
    shake(s, step, random);
    (void)update_neighbours(s);
    require_complete(s);
  }
}

RC_GTEST_PROP(NeighbourProperty, NoContactIsMissedInMotion2D, ()) { no_contact_is_missed<2>(); }
RC_GTEST_PROP(NeighbourProperty, NoContactIsMissedInMotion3D, ()) { no_contact_is_missed<3>(); }

}  // namespace
