// Putting grains into another order changes nothing but the last bits.
#include "common/neighbours/spatial_order.h"

#include <algorithm>
#include <cmath>

#include "common/dynamics/verlet.h"
#include "tests/support/small_packing.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

/// Grains of many sizes in a sheared periodic cell, in the order of their places on a lattice, largest anywhere.
template <int D>
System<D> sheared_multi_contact() {
  System<D> s = hertz_system<D>(0.4, 0.7, true);
  Vec<D> size;
  std::array<bool, D> periodic{};
  for (double& e : size.v) e = 1.2;
  periodic.fill(true);
  s.cell = box_cell<D>(size, periodic);
  s.cell.velocity_gradient[0][1] = 2.0;
  RandomStream random(5, RandomPurpose::test, 2);
  Vec<D> middle;
  for (double& x : middle.v) x = 0.6;
  for (const Vec<D>& x : shaken_lattice<D>(middle, 0.2, 6, 5)) {
    NewBody<D> grain = test_sphere<D>(x, 0.03 + 0.09 * random.uniform(), 2500.0);
    for (double& v : grain.velocity.v) v = 2.0 * random.uniform() - 1.0;
    add_grain(s.particles, grain);
  }
  return s;
}

/// Rounding grows as grains collide: 200 steps leave many digits.
constexpr double kTolerance = 1e-9;

template <int D>
void expect_close(const System<D>& a, const System<D>& b) {
  for (std::size_t u = 0; u < a.particles.sphere.size(); ++u) {
    EXPECT_LT(norm(a.particles.sphere[u].x - b.particles.sphere[u].x), kTolerance) << u;
    EXPECT_LT(norm(a.particles.velocity[u] - b.particles.velocity[u]), 1e3 * kTolerance) << u;
    EXPECT_EQ(a.particles.sphere[u].r, b.particles.sphere[u].r);
  }
}

template <int D>
void reorder_while_running() {
  System<D> plain = sheared_multi_contact<D>();
  System<D> ordered = plain;
  VelocityVerlet<D> first(2e-5);
  VelocityVerlet<D> second(2e-5);
  first.initialise(plain);
  second.initialise(ordered);
  first.advance(plain, 200);
  for (int k = 0; k < 4; ++k) {
    second.advance(ordered, 50);
    const auto springs = [](const System<D>& s) {
      double sum = 0.0;
      for (const auto& x : s.contacts.spring) sum += norm(x);
      return sum;
    };
    const double before = springs(ordered);
    EXPECT_GT(before, 0.0);
    const std::vector<Slot> order = spatial_order(ordered);
    reorder_grains(ordered, order);
    EXPECT_NEAR(springs(ordered), before, 1e-12 * before);
    if (k == 0) {
      EXPECT_FALSE(std::is_sorted(order.begin(), order.end())) << "nothing to put in order";
    }
  }
  EXPECT_FALSE(ordered.particles.id.empty());
  restore_order(ordered);
  EXPECT_TRUE(ordered.particles.id.empty());
  expect_close(plain, ordered);
}

TEST(SpatialOrder, HistoriesAndMotionGoOn) {
  reorder_while_running<2>();
  reorder_while_running<3>();
}

/// Numbers that no integer holds, and such as are none, in a run that has diverged.
template <int D>
void order_wild_places(bool periodic) {
  System<D> s = sheared_multi_contact<D>();
  s.cell.periodic.fill(periodic);
  std::size_t u = 0;
  for (const double place : {1e18, 1e300, -1.7e308, 1.7e308, HUGE_VAL, std::nan("")})
    for (int k = 0; k < D; ++k) s.particles.sphere[3 * ++u].x[k] = place;
  std::vector<Slot> order = spatial_order(s);
  std::sort(order.begin(), order.end());
  ASSERT_EQ(order.size(), static_cast<std::size_t>(s.particles.grains));
  for (std::size_t k = 0; k < order.size(); ++k) EXPECT_EQ(order[k], static_cast<Slot>(k));
}

TEST(SpatialOrder, WildPlacesHaveAnOrderToo) {
  for (const bool periodic : {false, true}) {
    order_wild_places<2>(periodic);
    order_wild_places<3>(periodic);
  }
}

TEST(SpatialOrder, SmallOnesFirstAndNeighboursClose) {
  const System3 s = sheared_multi_contact<3>();
  System3 t = s;
  reorder_grains(t, spatial_order(t));
  const auto mean_jump = [](const System3& system) {
    double sum = 0.0;
    const auto& spheres = system.particles.sphere;
    for (std::size_t u = 1; u < spheres.size(); ++u) sum += norm(spheres[u].x - spheres[u - 1].x);
    return sum / static_cast<double>(spheres.size());
  };
  EXPECT_LT(std::ilogb(t.particles.sphere.front().r / 0.03), std::ilogb(t.particles.sphere.back().r / 0.03));
  EXPECT_LT(mean_jump(t), 0.5);
  const std::vector<Slot> slots = slots_by_id(t.particles);
  for (std::size_t u = 0; u < slots.size(); ++u)
    EXPECT_EQ(t.particles.sphere[static_cast<std::size_t>(slots[u])].x, s.particles.sphere[u].x);
}

TEST(VelocityVerlet, ManyStepsAtOnceAreTheSameBits) {
  System3 single = sheared_multi_contact<3>();
  System3 many = single;
  VelocityVerlet<3> first(2e-5);
  VelocityVerlet<3> second(2e-5);
  first.initialise(single);
  second.initialise(many);
  for (int k = 0; k < 300; ++k) first.step(single);
  second.advance(many, 1);
  second.advance(many, 250);
  second.advance(many, 49);
  EXPECT_GT(single.neighbours.rebuilds, 2);
  expect_same_state(single, many);
}

/// Grains that flow with the cell keep their list: relative to the flow nothing moves.
TEST(VelocityVerlet, AListFollowsTheFlowOfTheCell) {
  System3 s = hertz_system<3>(0.3, 0.9, false);
  s.cell = box_cell<3>({{20.0, 20.0, 20.0}}, {true, true, true});
  s.cell.velocity_gradient[0][1] = 1.0;
  for (const Vec3& x : shaken_lattice<3>({{10.0, 10.0, 10.0}}, 2.0, 10, 3)) {
    NewBody<3> grain = test_sphere<3>(x, 0.4, 2500.0);
    grain.velocity[0] = x[1];
    add_grain(s.particles, grain);
  }
  VelocityVerlet<3> integrator(1e-4);
  integrator.initialise(s);
  integrator.advance(s, 400);  // strain 0.04: the fastest grains go 0.8 m, a margin is 0.05 m
  EXPECT_LE(s.neighbours.rebuilds, 2);
  integrator.advance(s, 2600);
  EXPECT_LT(s.neighbours.rebuilds, 12);
}

}  // namespace
