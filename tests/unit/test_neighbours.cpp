// The grid against testing all pairs.
#include "common/neighbours/hierarchical_grid.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <tuple>

#include "common/core/error.h"
#include "common/neighbours/verlet_list.h"
#include "tests/support/impact.h"
#include "tests/support/neighbour_pairs.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

/// Radii log-uniform from 1/ratio to 1, the largest always there, in a cell of edge 7 (positions wrapped).
template <int D>
Particles<D> cloud(const Cell<D>& cell, int n, double ratio, std::uint64_t seed) {
  RandomStream random(seed, RandomPurpose::test, 0);
  Particles<D> p;
  for (int k = 0; k < n; ++k) {
    Vec<D> fractions;
    for (double& f : fractions.v) f = random.uniform();
    const double r = k < 3 ? 1.0 : std::pow(ratio, -random.uniform());
    add_grain(p, test_sphere<D>(cell.edges * fractions, r, 1.0));
  }
  return p;
}

template <int D>
void expect_same_pairs(Box box, double ratio) {
  const Cell<D> cell = cell_of<D>(box, 7.0);
  const int n = ratio > 100.0 ? 500 : 150;
  const Particles<D> p = cloud<D>(cell, n, ratio, static_cast<std::uint64_t>(ratio) + 17U * static_cast<unsigned>(box));
  const std::vector<double> skin = default_skin(p);
  const Found grid = sorted(candidate_pairs(p, cell, skin));
  EXPECT_EQ(grid, sorted(candidate_pairs_brute_force(p, cell, skin)))
      << "ratio " << ratio << ", box " << static_cast<int>(box);
  EXPECT_FALSE(grid.empty());
  EXPECT_EQ(std::adjacent_find(grid.begin(), grid.end()), grid.end()) << "a pair was found twice";
}

TEST(Neighbours, GridFindsWhatAllPairsFind) {
  for (const double ratio : {1.0, 2.0, 10.0, 100.0, 1000.0})
    for (const Box box : {Box::open, Box::periodic, Box::half_periodic, Box::sheared}) {
      expect_same_pairs<2>(box, ratio);
      expect_same_pairs<3>(box, ratio);
    }
}

TEST(Neighbours, DegenerateArrangements) {
  const Cell<3> cell = open_cell<3>();
  Particles<3> p;
  EXPECT_TRUE(candidate_pairs(p, cell, {}).empty());
  add_grain(p, test_sphere<3>({}, 1.0, 1.0));
  EXPECT_TRUE(candidate_pairs(p, cell, {0.1}).empty());
  for (int k = 1; k < 40; ++k)
    add_grain(p, test_sphere<3>({{1.9 * k, 0.0, 0.0}}, k % 2 == 0 ? 1.0 : 1e-3, 1.0));  // a line
  const std::vector<double> skin(40, 0.05);
  EXPECT_EQ(sorted(candidate_pairs(p, cell, skin)), sorted(candidate_pairs_brute_force(p, cell, skin)));
}

/// What a diverged run leaves behind: finite, and farther away than any number of cells.
constexpr double kWild[] = {7e18, -7e18, 1e100, 1e300, -1e300, 1.7e308};

template <int D>
System<D> wild_system(Box box, double place, Slot many) {
  System<D> s;
  s.cell = cell_of<D>(box, 7.0);
  s.particles = cloud<D>(s.cell, 150, 4.0, 23);
  s.materials = {{"grain", 1.0, 1.0, 0.0, false}};
  s.laws = LawSet(1);
  for (Slot i = 0; i < many; ++i)
    for (int k = 0; k < D; ++k) s.particles.sphere[static_cast<std::size_t>(7 * i)].x[k] = i % 2 == 0 ? place : -place;
  return s;
}

template <int D>
void expect_lost(Box box, double place, Slot many) {
  System<D> s = wild_system<D>(box, place, many);
  try {
    rebuild_neighbours(s);
    ADD_FAILURE() << "taken for a state: " << place << ", box " << static_cast<int>(box);
  } catch (const UnusableResult& e) {
    EXPECT_NE(std::string(e.what()).find("grain 0 is lost"), std::string::npos) << e.what();
  }
}

TEST(Neighbours, GrainsFartherThanNumbersReachAreLost) {
  for (const double place : kWild)
    for (const Box box : {Box::open, Box::periodic, Box::half_periodic, Box::sheared})
      for (const Slot many : {1, 20}) {
        expect_lost<2>(box, place, many);
        expect_lost<3>(box, place, many);
      }
}

/// The search by itself, of whoever asks: a grain outside its cell has no image that could be told.
template <int D>
void expect_search_survives(Box box, double place, Slot many) {
  const System<D> s = wild_system<D>(box, place, many);
  const std::vector<double> skin = default_skin(s.particles);
  if (box != Box::open) {
    EXPECT_THROW((void)candidate_pairs(s.particles, s.cell, skin), UnusableResult) << place << static_cast<int>(box);
    return;
  }
  EXPECT_EQ(sorted(candidate_pairs(s.particles, s.cell, skin)),
            sorted(candidate_pairs_brute_force(s.particles, s.cell, skin)));
}

TEST(Neighbours, TheSearchSurvivesPlacesOutsideOfEveryCell) {
  for (const double place : kWild)
    for (const Box box : {Box::open, Box::periodic, Box::half_periodic, Box::sheared})
      for (const Slot many : {1, 20}) {
        expect_search_survives<2>(box, place, many);
        expect_search_survives<3>(box, place, many);
      }
}

/// Processor seconds of the quicker of two searches among grains side by side, some of which lie far away.
double search_seconds(Slot far, double place) {
  Particles<3> p;
  for (int n = 0; n < 27000; ++n)
    add_grain(p, test_sphere<3>({{2.0 * (n % 30), 2.0 * (n / 30 % 30), 2.0 * (n / 900)}}, 1.0, 1.0));
  for (Slot i = 0; i < far; ++i) p.sphere[static_cast<std::size_t>(100 * i)].x = {{place * (1.0 + i), -place, 1.0}};
  const std::vector<double> skin = default_skin(p);
  double best = HUGE_VAL;
  for (int k = 0; k < 2; ++k) {
    const std::clock_t start = std::clock();
    EXPECT_GT(candidate_pairs(p, open_cell<3>(), skin).size(), 70000U);
    best = std::min(best, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  return best;
}

/// Not by as much as their number, as when all the others share a cell.
TEST(Neighbours, GrainsThatFlewOffSlowTheSearchDownLittle) {
  const double near = search_seconds(0, 0.0);
  for (const double place : {1e4, 1e8, 1e12}) EXPECT_LT(search_seconds(1, place), 8.0 * near) << place;
  EXPECT_LT(search_seconds(12, 1e8), 8.0 * near);
}

/// A way of many periods is none to be lost on.
TEST(Neighbours, GrainsComeHomeFromAfar) {
  for (const double place : {7e3, -7e6, 7e9})
    for (const Box box : {Box::periodic, Box::half_periodic, Box::sheared}) {
      System<3> s = wild_system<3>(box, place, 20);
      rebuild_neighbours(s);
      for (Slot i = 0; i < s.particles.grains; ++i) {
        const Vec<3> unit = s.cell.fractional(s.particles.sphere[static_cast<std::size_t>(i)].x);
        for (int k = 0; k < 3; ++k)
          EXPECT_NEAR(unit[k], 0.5, s.cell.periodic[static_cast<std::size_t>(k)] ? 0.5 + 1e-6 : 1e10) << place;
      }
    }
}

TEST(Neighbours, ANarrowPeriodicCellIsRefused) {
  const Cell<3> cell = box_cell<3>({{3.9, 10.0, 10.0}}, {true, true, true});
  Particles<3> p;
  add_grain(p, test_sphere<3>({{1.0, 1.0, 1.0}}, 1.0, 1.0));
  add_grain(p, test_sphere<3>({{1.0, 5.0, 1.0}}, 1.0, 1.0));
  EXPECT_THROW((void)candidate_pairs(p, cell, {0.0, 0.0}), InputError);
}

/// Images stay two diameters apart however the cell leans, though its faces come nearer.
TEST(Neighbours, ALeaningCellNeedsNoMoreRoom) {
  Cell<3> cell = box_cell<3>({{4.1, 4.1, 4.1}}, {true, true, true});
  cell.edges[0][1] = 2.05;
  cell.edges[0][2] = -1.9;
  cell.edges[1][2] = 1.5;
  EXPECT_GE(shortest_period(cell), 4.1);
  const Particles<3> p = cloud<3>(cell, 60, 4.0, 11);
  const std::vector<double> skin(60, 0.02);
  EXPECT_EQ(sorted(candidate_pairs(p, cell, skin)), sorted(candidate_pairs_brute_force(p, cell, skin)));
}

}  // namespace
