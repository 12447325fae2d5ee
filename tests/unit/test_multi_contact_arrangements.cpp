// Directions of neighbours.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "microsim/multi_contact_arrangements.h"
#include "microsim/multi_contact_experiment.h"

namespace softgrain {
namespace {

double smallest_angle_degrees(const std::vector<Vec3>& all) {
  double largest = -1.0;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size(); ++j) largest = std::max(largest, dot(all[i], all[j]));
  return std::acos(largest) * 180.0 / std::numbers::pi;
}

TEST(MultiContactArrangements, AreUnitVectorsAtTheirAngles) {
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
  for (const auto& [arrangement, name] : enum_names<Arrangement>)
    for (const Vec3& d : directions_of(arrangement)) EXPECT_NEAR(norm(d), 1.0, 1e-14) << name;
}

TEST(MultiContactArrangements, BalancedOnesAddUpToNothing) {
  for (const Arrangement balanced :
       {Arrangement::opposite, Arrangement::tetrahedron, Arrangement::cube, Arrangement::icosahedron}) {
    Vec3 sum{};
    for (const Vec3& d : directions_of(balanced)) sum += d;
    EXPECT_NEAR(norm(sum), 0.0, 1e-14) << to_string(balanced);
  }
}

TEST(MultiContactArrangements, RandomDirectionsAreFixedAndApart) {
  const auto directions = directions_of(Arrangement::random_8);
  ASSERT_EQ(directions.size(), 8U);
  EXPECT_GT(smallest_angle_degrees(directions), 45.0);
  EXPECT_TRUE(directions == directions_of(Arrangement::random_8));
}

TEST(MultiContactArrangements, TheShallowOneIsTheFirst) {
  EXPECT_EQ(depth_shares(Arrangement::beside_five, 0.4), (std::vector<double>{0.4, 1.0, 1.0, 1.0, 1.0, 1.0}));
  EXPECT_EQ(depth_shares(Arrangement::opposite, 0.4), (std::vector<double>{1.0, 1.0}));
}

ScatterChoice scattered(std::int64_t count, std::uint64_t draw) {
  ScatterChoice choice;
  choice.count = count;
  choice.draw = draw;
  choice.ratios = {0.5, 2.0};
  return choice;
}

/// Whatever is drawn holds a body from all sides, and one neighbour presses as deep as was asked for.
TEST(MultiContactArrangements, ScatteredNeighboursLeaveNoWayOut) {
  for (const std::int64_t count : {4, 5, 6, 8, 12})
    for (const std::uint64_t draw : {1U, 2U, 3U}) {
      const auto all = scattered_neighbours(scattered(count, draw));
      ASSERT_EQ(all.size(), static_cast<std::size_t>(count));
      double deepest = 0.0;
      for (const ScatteredNeighbour& n : all) {
        EXPECT_NEAR(norm(n.partner.direction), 1.0, 1e-12);
        EXPECT_GE(n.share, 0.3);
        deepest = std::max(deepest, n.share);
      }
      EXPECT_EQ(deepest, 1.0);
      for (const ScatteredNeighbour& probe : scattered_neighbours(scattered(20, 77))) {
        double nearest = -1.0;
        for (const ScatteredNeighbour& n : all)
          nearest = std::max(nearest, dot(n.partner.direction, probe.partner.direction));
        EXPECT_GT(nearest, 0.1) << count << " neighbours, draw " << draw;
      }
    }
}

TEST(MultiContactArrangements, ADrawIsTheSameAlwaysAndAnotherOneIsNot) {
  const auto one = scattered_neighbours(scattered(6, 1));
  const auto again = scattered_neighbours(scattered(6, 1));
  const auto other = scattered_neighbours(scattered(6, 2));
  EXPECT_EQ(one[3].partner.direction, again[3].partner.direction);
  EXPECT_EQ(one[3].share, again[3].share);
  EXPECT_NE(one[3].partner.direction, other[3].partner.direction);
  // Of one kind or mixed, they come from the same sides.
  ScatterChoice planes = scattered(6, 1);
  planes.kind = PartnerKind::plane;
  planes.smooth = true;
  for (const ScatteredNeighbour& n : scattered_neighbours(planes)) {
    EXPECT_EQ(n.partner.kind, PartnerKind::plane);
    EXPECT_TRUE(n.partner.smooth);
    EXPECT_EQ(n.partner.ratio, 0.0);
  }
  EXPECT_EQ(scattered_neighbours(planes)[2].partner.direction, one[2].partner.direction);
}

TEST(MultiContactArrangements, MixedNeighboursAreOfAllKindsAndSizes) {
  int kinds[3] = {0, 0, 0};
  int large = 0;
  for (std::uint64_t draw = 1; draw <= 50; ++draw)
    for (const ScatteredNeighbour& n : scattered_neighbours(scattered(6, draw))) {
      ++kinds[static_cast<int>(n.partner.kind)];
      large += n.partner.ratio == 2.0 ? 1 : 0;
      EXPECT_EQ(n.partner.kind == PartnerKind::plane, n.partner.ratio == 0.0);
    }
  EXPECT_NEAR(kinds[static_cast<int>(PartnerKind::solid)], 180, 30);
  EXPECT_NEAR(kinds[static_cast<int>(PartnerKind::plane)], 60, 24);
  EXPECT_NEAR(kinds[static_cast<int>(PartnerKind::soft)], 60, 24);
  EXPECT_NEAR(large, 120, 30);
}

TEST(MultiContactArrangements, SlidesGoAcross) {
  EXPECT_EQ(slide_direction({{1.0, 0.0, 0.0}}), (Vec3{{0.0, 1.0, 0.0}}));
  for (const Vec3& d : directions_of(Arrangement::icosahedron)) {
    EXPECT_NEAR(dot(d, slide_direction(d)), 0.0, 1e-15);
    EXPECT_NEAR(norm(slide_direction(d)), 1.0, 1e-15);
  }
}

}  // namespace
}  // namespace softgrain
