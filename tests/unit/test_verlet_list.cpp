// Lists and histories while things move: no contact is missed, and no list is made that need not be.
#include "common/neighbours/verlet_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "common/dynamics/force_pass.h"
#include "common/dynamics/verlet.h"
#include "tests/support/impact.h"
#include "tests/support/neighbour_pairs.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

/// Every touching pair is in the list, at every step, with its image.
template <int D>
void expect_complete_list(const System<D>& s) {
  const std::vector<double> none(static_cast<std::size_t>(s.particles.size()), 0.0);
  Found listed;
  for (std::size_t c = 0; c < s.contacts.i.size(); ++c)
    if (s.contacts.j[c] < s.particles.grains)
      listed.emplace_back(s.contacts.i[c], s.contacts.j[c], s.contacts.image[c]);
  std::sort(listed.begin(), listed.end());
  for (const auto& touching : sorted(candidate_pairs_brute_force(s.particles, s.cell, none)))
    ASSERT_TRUE(std::binary_search(listed.begin(), listed.end(), touching))
        << std::get<0>(touching) << " and " << std::get<1>(touching) << " touch unseen at step " << s.step;
}

template <int D>
void shear_and_watch(double rate) {
  System<D> s = hertz_system<D>(0.3, 0.9, false);
  s.cell = cell_of<D>(Box::periodic, 1.2);
  s.cell.velocity_gradient[0][1] = rate;
  if constexpr (D == 3) {
    s.cell.velocity_gradient[0][2] = -0.5 * rate;
    s.cell.velocity_gradient[1][2] = 0.7 * rate;
  }
  RandomStream random(3, RandomPurpose::test, 2);
  Vec<D> middle;
  for (double& x : middle.v) x = 0.6;
  for (const Vec<D>& x : shaken_lattice<D>(middle, 0.3, 4, 5)) {
    NewBody<D> grain = test_sphere<D>(x, 0.05 + 0.08 * random.uniform(), 2500.0);
    for (double& v : grain.velocity.v) v = 8.0 * random.uniform() - 4.0;
    add_grain(s.particles, grain);
  }
  VelocityVerlet<D> integrator(1e-4);
  integrator.initialise(s);
  for (int k = 0; k < 3000; ++k) {
    integrator.step(s);
    expect_complete_list(s);
    if (::testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GT(s.neighbours.rebuilds, 20);
  for (int c = 1; c < D; ++c)
    for (int r = 0; r < c; ++r)
      EXPECT_LT(std::abs(s.cell.edges[r][c]), 0.75 * s.cell.edges[r][r]) << "the cell must not tilt away";
}

TEST(VerletList, NoContactIsMissedWhileACellIsSheared) {
  shear_and_watch<2>(5.0);
  shear_and_watch<3>(5.0);
}

/// Grains that stand still meet their images when a cell beside walls shrinks: every body takes half of what the image
/// comes nearer.
TEST(VerletList, NoImageIsMissedWhileACellBesideAWallShrinks) {
  for (const double start : {1.3, 1.4, 1.5}) {
    System3 s = hertz_system<3>(0.0, 1.0, false);
    s.cell = box_cell<3>({{2.0, 2.0, 2.0}}, {true, true, false});
    add_grain(s.particles, test_sphere<3>({{0.15, 0.5, 1.0}}, 0.1, 2500.0));
    add_grain(s.particles, test_sphere<3>({{start, 0.5, 1.0}}, 0.1, 2500.0));
    NewBody<3> plane;
    add_plane(s.particles, plane, Vec3{{0.0, 0.0, 1.0}});
    bool met = false;
    while (s.cell.edges[0][0] > start + 0.02 && !::testing::Test::HasFatalFailure()) {
      s.cell.edges[0][0] -= 1e-3;
      update_neighbours(s);
      expect_complete_list(s);
      met = met || s.contacts.size() > 0;
    }
    EXPECT_TRUE(met);
  }
}

/// Grains that follow a cell which is pressed together come nearer by the strain times their distance, though none
/// moves against the cell: their own size counts.
TEST(VerletList, NoContactIsMissedWhileGrainsFollowAShrinkingCell) {
  for (const double gap : {0.03, 0.05, 0.1}) {
    System3 s = hertz_system<3>(0.0, 1.0, false);
    s.cell = box_cell<3>({{2.0, 2.0, 2.0}}, {true, true, true});
    add_grain(s.particles, test_sphere<3>({{0.5, 0.5, 1.0}}, 0.1, 2500.0));
    add_grain(s.particles, test_sphere<3>({{0.7 + gap, 0.5, 1.0}}, 0.1, 2500.0));
    const auto apart = [&] { return s.particles.sphere[1].x[0] - s.particles.sphere[0].x[0]; };
    update_neighbours(s);
    ASSERT_EQ(s.contacts.size(), 0);
    while (apart() > 0.195 && !::testing::Test::HasFatalFailure()) {
      s.cell.edges[0][0] *= 0.999;
      for (auto& sphere : s.particles.sphere) sphere.x[0] *= 0.999;
      update_neighbours(s);
      expect_complete_list(s);
    }
    EXPECT_EQ(s.contacts.size(), 1);
  }
}

/// Pairs of grains that overlap.
int touching_now(const System3& s) {
  const std::vector<double> none(static_cast<std::size_t>(s.particles.size()), 0.0);
  return static_cast<int>(candidate_pairs_brute_force(s.particles, s.cell, none).size());
}

/// Grains in a box of six planes, 2.3 radii from one to the next; the planes by axis and side.
struct WalledLattice {
  static constexpr int kSide = 10;
  static constexpr double kEdge = 2.3 * kSide;
  System3 s = hertz_system<3>(0.0, 1.0, false);
  std::array<std::size_t, 6> plane{};

  WalledLattice() {
    RandomStream random(5, RandomPurpose::test, 7);
    for (int k = 0; k < kSide * kSide * kSide; ++k) {
      Vec3 x{{2.3 * (k % kSide), 2.3 * (k / kSide % kSide), 2.3 * (k / kSide / kSide)}};
      for (double& c : x.v) c += 1.1 + 0.1 * random.uniform();
      add_grain(s.particles, test_sphere<3>(x, 1.0, 2500.0));
    }
    for (std::size_t k = 0; k < 6; ++k) {
      NewBody<3> body;
      body.x[static_cast<int>(k / 2)] = k % 2 == 0 ? 0.0 : kEdge;
      Vec3 normal{};
      normal[static_cast<int>(k / 2)] = k % 2 == 0 ? 1.0 : -1.0;
      plane[k] = at(add_plane(s.particles, body, normal));
    }
  }

  /// Every grain that touches a plane is listed with it.
  void expect_complete() {
    expect_complete_list(s);
    std::set<std::pair<Slot, Slot>> listed;
    for (std::size_t c = 0; c < s.contacts.i.size(); ++c) listed.insert({s.contacts.i[c], s.contacts.j[c]});
    for (Slot i = 0; i < s.particles.grains; ++i)
      for (const std::size_t k : plane) {
        const Vec3 way = s.particles.sphere[at(i)].x - s.particles.sphere[k].x;
        const auto slot = static_cast<Slot>(k);
        const bool touches = dot(way, s.particles.normal_of(slot)) < s.particles.sphere[at(i)].r;
        ASSERT_TRUE(!touches || listed.count({i, slot}) == 1) << i << " at plane " << k;
      }
  }
};

/// What goes with the walls keeps its list: the far side of the box moves by many margins, neighbours by a part of one.
TEST(VerletList, GrainsThatGoWithTheWallsOfABoxKeepTheirList) {
  WalledLattice box;
  update_neighbours(box.s);
  const std::int64_t before = box.s.neighbours.rebuilds;
  for (int step = 0; step < 150 && !::testing::Test::HasFatalFailure(); ++step) {
    for (auto& sphere : box.s.particles.sphere) {  // about a corner, walls included
      sphere.x[0] *= 0.9985;
      sphere.x[1] *= 0.9995;
      sphere.x[2] += 0.01;
    }
    update_neighbours(box.s);
    box.expect_complete();
  }
  EXPECT_GT(touching_now(box.s), 500);
  EXPECT_LT(box.s.neighbours.rebuilds - before, 12) << "the far side moves by 40 margins";
}

/// A piston comes down on grains that stand still: to follow them with the box would miss that.
TEST(VerletList, GrainsThatStandStillBetweenMovingWallsKeepTheirListToo) {
  WalledLattice box;
  update_neighbours(box.s);
  const std::int64_t before = box.s.neighbours.rebuilds;
  for (int step = 0; step < 150 && !::testing::Test::HasFatalFailure(); ++step) {
    box.s.particles.sphere[box.plane[5]].x[2] -= 0.01;
    update_neighbours(box.s);
    box.expect_complete();
  }
  EXPECT_LT(box.s.neighbours.rebuilds - before, 12);
}

/// The reduced cell spans the same lattice: every old edge is a whole combination of new ones.
TEST(VerletList, ATiltedCellIsReplacedByTheSameLattice) {
  System3 s = hertz_system<3>(0.0, 1.0, false);
  s.cell = cell_of<3>(Box::periodic, 1.2);
  const Matrix<3> before{{{{{1.2, 0.9, 2.9}}, {{0.0, 1.2, 1.7}}, {{0.0, 0.0, 1.2}}}}};
  s.cell.edges = before;
  add_grain(s.particles, test_sphere<3>({{0.1, 0.2, 0.3}}, 0.1, 1.0));
  rebuild_neighbours(s);
  for (int c = 0; c < 3; ++c) {
    Vec3 edge;
    for (int r = 0; r < 3; ++r) edge[r] = before[r][c];
    const Vec3 n = s.cell.fractional(edge);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(n[k], std::round(n[k]), 1e-12);
  }
  for (int c = 1; c < 3; ++c)
    for (int r = 0; r < c; ++r) EXPECT_LE(std::abs(s.cell.edges[r][c]), 0.5001 * s.cell.edges[r][r]);
}

TEST(VerletList, HistorySurvivesARebuildAndAWrap) {
  System3 s = hertz_system<3>(0.5, 1.0, true);
  s.cell = cell_of<3>(Box::periodic, 1.0);
  add_grain(s.particles, test_sphere<3>({{0.92, 0.5, 0.5}}, 0.1, 1.0));
  add_grain(s.particles, test_sphere<3>({{0.109, 0.5, 0.5}}, 0.1, 1.0));  // touch through the boundary
  s.particles.velocity[0] = {{0.0, 0.3, -0.2}};
  force_pass(s, 1e-4);
  s.contacts.commit();
  ASSERT_EQ(s.contacts.size(), 1);
  const Vec3 spring = s.contacts.spring[0];
  const double memory = s.contacts.memory[0];
  ASSERT_GT(norm(spring), 0.0);
  ASSERT_GT(memory, 0.0);
  for (auto& sphere : s.particles.sphere) sphere.x[0] += 0.0805;  // body 0 goes through the boundary
  rebuild_neighbours(s);
  ASSERT_EQ(s.contacts.size(), 1);
  EXPECT_LT(s.particles.sphere[0].x[0], 0.1);
  EXPECT_EQ(s.contacts.image[0], home_image<3>());
  EXPECT_TRUE(s.contacts.spring[0] == spring);
  EXPECT_EQ(s.contacts.memory[0], memory);
}

TEST(VerletList, HistoryIsLostOnSeparation) {
  System3 s = hertz_system<3>(0.5, 1.0, true);
  add_grain(s.particles, test_sphere<3>({}, 0.1, 1.0));
  add_grain(s.particles, test_sphere<3>({{0.199, 0.0, 0.0}}, 0.1, 1.0));
  s.particles.velocity[0] = {{0.0, 0.3, -0.2}};
  force_pass(s, 1e-4);
  s.contacts.commit();
  ASSERT_GT(norm(s.contacts.spring[0]), 0.0);
  s.particles.sphere[1].x[0] = 0.2005;
  force_pass(s, 1e-4);
  s.contacts.commit();
  ASSERT_EQ(s.contacts.size(), 1) << "still listed";
  EXPECT_EQ(norm(s.contacts.spring[0]), 0.0);
  EXPECT_EQ(s.contacts.memory[0], 0.0);
}

/// Two disks whose attraction reaches far, near each other in a cell that is squeezed. No pair may come within reach
/// unlisted.
System<2> distant_disks(double gap) {
  System<2> s;
  s.materials.resize(1);
  s.laws = LawSet(1);
  s.laws.set(0, 0, CohesiveDisk<false, false>{100.0, 0.0, 0.0, 0.0, 1.0, 4.0, 0.0, 0.0});
  s.cell = box_cell<2>({{30.0, 30.0}}, {true, true});
  for (const double x : {10.0, 12.0 + gap}) add_grain(s.particles, test_sphere<2>({{x, 15.0}}, 1.0, 1.0));
  rebuild_neighbours(s);
  return s;
}

void squeeze(System<2>& s, double strain) {
  s.cell.edges[0][0] *= 1.0 - strain;
  for (auto& sphere : s.particles.sphere) sphere.x[0] *= 1.0 - strain;
}

TEST(VerletList, AttractionAtADistanceIsSeenInAStrainedCell) {
  for (const double gap : {4.26, 4.3, 4.5}) {
    System<2> s = distant_disks(gap);
    ASSERT_EQ(s.contacts.size(), 0) << gap;
    for (int k = 0; k < 40; ++k) {
      squeeze(s, 0.005);
      force_pass(s, 0.0, History::none);
      const double now = s.particles.sphere[1].x[0] - s.particles.sphere[0].x[0] - 2.0;
      const double expected = now < 4.0 ? 1.0 - now / 4.0 : 0.0;
      ASSERT_NEAR(s.particles.force[0][0], expected, 1e-12) << gap << ", strained " << k + 1 << " times";
    }
  }
}

TEST(VerletList, AttractionAtADistanceIsSeenWhileACellFlows) {
  System<2> s = distant_disks(4.3);
  s.cell.velocity_gradient[0][0] = -1.0;
  s.particles.inverse_mass.assign(2, 0.0);
  for (std::size_t u = 0; u < 2; ++u) s.particles.velocity[u][0] = -s.particles.sphere[u].x[0];
  VelocityVerlet<2> integrator(1e-3);
  integrator.initialise(s);
  for (int k = 0; k < 100; ++k) {
    integrator.step(s);
    const double now = s.particles.sphere[1].x[0] - s.particles.sphere[0].x[0] - 2.0;
    const double expected = now < 4.0 ? 1.0 - now / 4.0 : 0.0;
    ASSERT_NEAR(s.particles.force[0][0], expected, 1e-12) << k;
    for (std::size_t u = 0; u < 2; ++u) s.particles.velocity[u][0] = -s.particles.sphere[u].x[0];
  }
}

/// Half the distance between images belongs to a grain with margin and reach: a cell that is wide enough for the reach
/// must not be refused because of the margin.
TEST(VerletList, MarginsLeaveRoomForTheReach) {
  System<2> s = distant_disks(0.5);
  s.cell = box_cell<2>({{12.2, 12.2}}, {true, true});
  s.particles.sphere[0].x = {{3.0, 3.0}};
  s.particles.sphere[1].x = {{5.5, 3.0}};
  EXPECT_NO_THROW(rebuild_neighbours(s));
  EXPECT_EQ(s.contacts.size(), 1);
}

/// A crowd that hardly moves and one grain that flies through it: with the margin of the flyer for all, or that of the
/// crowd for the flyer, lists would be made every few passes.
TEST(VerletList, AGrainThatFliesHasAMarginOfItsOwn) {
  System3 s = hertz_system<3>(0.5, 1.0, true);
  for (int k = 0; k < 1000; ++k)
    add_grain(s.particles, test_sphere<3>({{3.0 * (k % 10), 3.0 * (k / 10 % 10), 3.0 * (k / 100)}}, 1.0, 1.0));
  add_grain(s.particles, test_sphere<3>({{-5.0, 1.5, 1.5}}, 1.15, 1.0));
  const std::size_t flyer = 1000;
  s.particles.inverse_mass.assign(flyer + 1, 0.0);
  for (int pass = 0; pass < 400; ++pass) {
    for (std::size_t u = 0; u < flyer; ++u)
      s.particles.sphere[u].x[1] += (u % 2 == 0 ? 1e-3 : -1e-3) * (pass % 2 == 0 ? 1 : -1);
    s.particles.sphere[flyer].x[0] += 0.08;
    force_pass(s, 0.0, History::none);
    std::size_t touching = 0;  // four at a time, between columns of grains
    for (std::size_t u = 0; u < flyer; ++u)
      touching += norm(s.particles.sphere[u].x - s.particles.sphere[flyer].x) < 2.15 ? 1 : 0;
    std::size_t listed = 0;
    for (std::size_t c = 0; c < at(s.contacts.size()); ++c) listed += at(s.contacts.j[c]) == flyer ? 1 : 0;
    ASSERT_GE(listed, touching) << pass;
  }
  EXPECT_GT(s.neighbours.skin[flyer], 1.0);
  EXPECT_LT(s.neighbours.skin[0], 0.51);
  EXPECT_LT(s.neighbours.rebuilds, 60) << "32 m at 8 radii a list, and the first few";
  EXPECT_LT(s.contacts.size(), 400) << "the crowd touches nowhere";
}

}  // namespace
