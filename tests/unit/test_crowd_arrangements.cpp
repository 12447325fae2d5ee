// Directions of neighbours.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "microsim/crowd_arrangements.h"
#include "microsim/crowd_experiment.h"

namespace softgrain {
namespace {

double smallest_angle_degrees(const std::vector<Vec3>& all) {
  double largest = -1.0;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size(); ++j) largest = std::max(largest, dot(all[i], all[j]));
  return std::acos(largest) * 180.0 / std::numbers::pi;
}

TEST(CrowdArrangements, AreUnitVectorsAtTheirAngles) {
  struct Known {
    Arrangement name;
    std::size_t count;
    double angle;
  };
  for (const Known& k : {Known{Arrangement::opposite, 2, 180.0}, Known{Arrangement::orthogonal, 2, 90.0},
                         Known{Arrangement::sixty, 2, 60.0}, Known{Arrangement::octant, 3, 90.0},
                         Known{Arrangement::tetrahedron, 4, 109.471220634}, Known{Arrangement::cube, 6, 90.0},
                         Known{Arrangement::icosahedron, 12, 63.434948823}, Known{Arrangement::beside_five, 6, 90.0}}) {
    const auto directions = directions_of(k.name);
    EXPECT_EQ(directions.size(), k.count) << to_string(k.name);
    EXPECT_NEAR(smallest_angle_degrees(directions), k.angle, 1e-6) << to_string(k.name);
  }
  for (const auto& [arrangement, name] : words<Arrangement>)
    for (const Vec3& d : directions_of(arrangement)) EXPECT_NEAR(norm(d), 1.0, 1e-14) << name;
}

TEST(CrowdArrangements, BalancedOnesAddUpToNothing) {
  for (const Arrangement balanced :
       {Arrangement::opposite, Arrangement::tetrahedron, Arrangement::cube, Arrangement::icosahedron}) {
    Vec3 sum{};
    for (const Vec3& d : directions_of(balanced)) sum += d;
    EXPECT_NEAR(norm(sum), 0.0, 1e-14) << to_string(balanced);
  }
}

TEST(CrowdArrangements, RandomDirectionsAreFixedAndApart) {
  const auto directions = directions_of(Arrangement::random_8);
  ASSERT_EQ(directions.size(), 8U);
  EXPECT_GT(smallest_angle_degrees(directions), 45.0);
  EXPECT_TRUE(directions == directions_of(Arrangement::random_8));
}

TEST(CrowdArrangements, TheShallowOneIsTheFirst) {
  EXPECT_EQ(depth_shares(Arrangement::beside_five, 0.4), (std::vector<double>{0.4, 1.0, 1.0, 1.0, 1.0, 1.0}));
  EXPECT_EQ(depth_shares(Arrangement::opposite, 0.4), (std::vector<double>{1.0, 1.0}));
}

TEST(CrowdArrangements, SlidesGoAcross) {
  EXPECT_EQ(slide_direction({{1.0, 0.0, 0.0}}), (Vec3{{0.0, 1.0, 0.0}}));
  for (const Vec3& d : directions_of(Arrangement::icosahedron)) {
    EXPECT_NEAR(dot(d, slide_direction(d)), 0.0, 1e-15);
    EXPECT_NEAR(norm(slide_direction(d)), 1.0, 1e-15);
  }
}

}  // namespace
}  // namespace softgrain
