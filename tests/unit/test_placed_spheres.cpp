// Placing bodies: the grid answers as testing all bodies does, to the bit, whatever their sizes.
#include <gtest/gtest.h>

#include <cmath>

#include "common/core/particles.h"
#include "common/core/random.h"
#include "macrosim/placed_spheres.h"
#include "macrosim/preparation.h"

namespace softgrain {
namespace {

bool collides_with_any(const std::vector<MacroBody>& bodies, std::size_t placed, const Vec3& x, double r) {
  for (std::size_t j = 0; j < placed; ++j) {
    const double reach = bodies[j].r + r;
    if (norm2(bodies[j].x - x) < reach * reach) return true;
  }
  return false;
}

/// The same draws, every pair tested.
void place_by_testing_all(std::vector<MacroBody>& bodies, double edge, RandomStream& random) {
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const double r = bodies[k].r;
    do {
      for (int a = 0; a < 3; ++a) bodies[k].x[a] = r + random.uniform() * (edge - 2.0 * r);
    } while (collides_with_any(bodies, k, bodies[k].x, r));
  }
}

std::vector<MacroBody> some_bodies(std::size_t count, double exponent, double polydispersity) {
  RandomStream random(5, RandomPurpose::radii, 0);
  std::vector<MacroBody> bodies(count);
  for (MacroBody& b : bodies) b.r = power_law_radius(exponent, 0.016, polydispersity, random.uniform());
  std::stable_sort(bodies.begin(), bodies.end(), [](const MacroBody& a, const MacroBody& b) { return a.r > b.r; });
  return bodies;
}

double edge_of(const std::vector<MacroBody>& bodies, double fraction) {
  double volume = 0.0;
  for (const MacroBody& b : bodies) volume += kSphereVolume * (b.r * b.r * b.r);
  return std::cbrt(volume / fraction);
}

TEST(PlacedSpheres, PlacesAreThoseOfTestingAllBodies) {
  struct Case {
    std::size_t count;
    double exponent;
    double polydispersity;
  };
  for (const Case& c : {Case{1500, 3.5, 2.0}, Case{1500, 3.5, 30.0}, Case{800, 1.2, 100.0}, Case{1, 3.5, 2.0}}) {
    std::vector<MacroBody> expected = some_bodies(c.count, c.exponent, c.polydispersity);
    const MacroPacking packing = place_loosely(expected, 3, 1, 0.25);
    RandomStream random(3, kMacroPositions, 1);
    place_by_testing_all(expected, edge_of(expected, 0.25), random);
    ASSERT_EQ(packing.high[0], edge_of(expected, 0.25)) << "placed in a larger box: the case is no test";
    for (std::size_t k = 0; k < expected.size(); ++k) ASSERT_EQ(packing.bodies[k].x, expected[k].x) << k;
  }
}

/// Every first fraction is tried, as small as may be.
TEST(PlacedSpheres, ASmallFirstFractionIsTried) {
  for (const double fraction : {0.05, 0.02}) {
    const std::vector<MacroBody> bodies = some_bodies(20, 3.5, 2.0);
    EXPECT_EQ(place_loosely(bodies, 3, 1, fraction).high[0], edge_of(bodies, fraction));
  }
}

/// Questions at random, also for spheres larger than those that are there and near the faces.
TEST(PlacedSpheres, AnswersAreThoseOfTestingAllBodies) {
  std::vector<MacroBody> bodies = some_bodies(400, 2.0, 20.0);
  const double edge = edge_of(bodies, 0.1);
  RandomStream random(9, RandomPurpose::positions, 0);
  std::vector<double> radii;
  for (const MacroBody& b : bodies) radii.push_back(b.r);
  PlacedSpheres placed(edge, radii);
  for (MacroBody& b : bodies) {
    for (int a = 0; a < 3; ++a) b.x[a] = random.uniform() * edge;
    placed.add(b.x, b.r);
  }
  int yes = 0;
  for (int k = 0; k < 20000; ++k) {
    Vec3 x{};
    for (int a = 0; a < 3; ++a) x[a] = random.uniform() * edge;
    const double r = 0.05 * edge * std::pow(random.uniform(), 4);
    const bool expected = collides_with_any(bodies, bodies.size(), x, r);
    ASSERT_EQ(placed.collides(x, r), expected) << k;
    yes += expected ? 1 : 0;
  }
  EXPECT_GT(yes, 1000);
  EXPECT_LT(yes, 19000);
}

}  // namespace
}  // namespace softgrain
