// Filling of voids: known holes of lattices, no overlap, largest first, against dense sampling.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <numbers>

#include "common/core/error.h"
#include "common/core/random.h"
#include "common/packing/void_filling.h"

namespace softgrain {
namespace {

/// Over all images of a periodic cell.
double periodic_clearance(const std::vector<PackedSphere>& spheres, const VoidDomain& domain, const Vec3& x) {
  const Vec3 period = domain.high - domain.low;
  double room = std::numeric_limits<double>::infinity();
  for (const PackedSphere& s : spheres)
    for (int image = 0; image < 27; ++image) {
      const Vec3 shift{{(image % 3 - 1) * period[0], (image / 3 % 3 - 1) * period[1], (image / 9 - 1) * period[2]}};
      room = std::min(room, norm(x - s.x - shift) - s.r);
    }
  return room;
}

double clearance(const std::vector<PackedSphere>& spheres, const VoidDomain& domain, const Vec3& x) {
  if (domain.shape == VoidDomain::Shape::cell) return periodic_clearance(spheres, domain, x);
  double room = 1.0 - norm(x);
  if (domain.shape == VoidDomain::Shape::box) {
    room = domain.high[0] - x[0];
    for (int k = 0; k < 3; ++k) room = std::min({room, domain.high[k] - x[k], x[k] - domain.low[k]});
  }
  for (const PackedSphere& s : spheres) room = std::min(room, norm(x - s.x) - s.r);
  return room;
}

/// Spheres of radii in [r/4, r] at random places without overlap.
std::vector<PackedSphere> random_spheres(const VoidDomain& domain, int wanted, double r, std::uint64_t index) {
  RandomStream random(5, RandomPurpose::test, index);
  std::vector<PackedSphere> out;
  for (int trial = 0; trial < 100000 && static_cast<int>(out.size()) < wanted; ++trial) {
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = domain.low[k] + random.uniform() * (domain.high[k] - domain.low[k]);
    const double wish = r * (0.25 + 0.75 * random.uniform());
    if (clearance(out, domain, x) >= wish) out.push_back({x, wish});
  }
  return out;
}

void expect_sound(const std::vector<PackedSphere>& placed, const VoidDomain& domain, const VoidFilling& filling,
                  double r_min, double r_max) {
  std::vector<PackedSphere> all = placed;
  double before = r_max;
  for (const PackedSphere& s : filling.added) {
    EXPECT_GE(clearance(all, domain, s.x), s.r * (1.0 - 1e-12));
    EXPECT_LE(clearance(all, domain, s.x), s.r * (1.0 + 1e-9)) << "does not touch";
    EXPECT_LE(s.r, before);
    EXPECT_GE(s.r, r_min);
    before = s.r;
    all.push_back(s);
  }
}

TEST(VoidFilling, TheHoleOfASimpleCubicLattice) {
  std::vector<PackedSphere> lattice;
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b)
      for (int c = 0; c < 4; ++c) lattice.push_back({{{1.0 + 2 * a, 1.0 + 2 * b, 1.0 + 2 * c}}, 1.0});
  const auto domain = VoidDomain::box({{1.0, 1.0, 1.0}}, {{7.0, 7.0, 7.0}});
  VoidFillingOptions options;
  options.r_min = 0.7;
  const VoidFilling filling = fill_voids(lattice, domain, options);
  EXPECT_EQ(filling.added.size(), 27U);
  for (const PackedSphere& s : filling.added) EXPECT_NEAR(s.r, std::numbers::sqrt3 - 1.0, 1e-10);
  EXPECT_LT(filling.next_hole, 0.7);
}

TEST(VoidFilling, TheHolesOfAFaceCentredCubicLattice) {
  std::vector<PackedSphere> lattice;
  const double edge = 2.0 * std::numbers::sqrt2;
  for (int a = -1; a <= 5; ++a)
    for (int b = -1; b <= 5; ++b)
      for (int c = -1; c <= 5; ++c)
        if ((a + b + c) % 2 == 0) lattice.push_back({{{a * edge / 2, b * edge / 2, c * edge / 2}}, 1.0});
  // Wide enough that the wall cuts no hole: one cell of the lattice and a radius around it.
  const auto domain = VoidDomain::box({{-0.5, -0.5, -0.5}}, {{edge + 0.5, edge + 0.5, edge + 0.5}});
  VoidFillingOptions options;
  options.r_min = 0.2;
  const VoidFilling filling = fill_voids(lattice, domain, options);
  const auto octahedral = std::count_if(filling.added.begin(), filling.added.end(), [](const PackedSphere& s) {
    return std::abs(s.r - (std::numbers::sqrt2 - 1.0)) < 1e-10;
  });
  const auto tetrahedral = std::count_if(filling.added.begin(), filling.added.end(), [](const PackedSphere& s) {
    return std::abs(s.r - (std::sqrt(1.5) - 1.0)) < 1e-10;
  });
  EXPECT_EQ(octahedral, 13);  // middle of the cell and of its twelve edges
  EXPECT_EQ(tetrahedral, 8);
  expect_sound(lattice, domain, filling, 0.2, 1.0);
}

TEST(VoidFilling, TheLargestHoleIsThatOfDenseSampling) {
  for (std::uint64_t k = 0; k < 4; ++k) {
    const auto domain = VoidDomain::box({{-0.1, 0.0, 0.2}}, {{0.9, 1.2, 1.0}});
    const auto spheres = random_spheres(domain, 60, 0.2, k);
    double best = 0.0;
    constexpr int n = 80;
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b)
        for (int c = 0; c < n; ++c) {
          const Vec3 share{{(a + 0.5) / n, (b + 0.5) / n, (c + 0.5) / n}};
          Vec3 x = domain.low;
          for (int i = 0; i < 3; ++i) x[i] += share[i] * (domain.high[i] - domain.low[i]);
          best = std::max(best, clearance(spheres, domain, x));
        }
    const PackedSphere hole = largest_void(spheres, domain, 0.01, 1e-3);
    EXPECT_GE(hole.r, best * (1.0 - 1e-3));
    EXPECT_LE(hole.r, best + 0.5 * std::sqrt(1.0 + 1.44 + 0.64) / n);  // the sampling's own coarseness
    EXPECT_NEAR(clearance(spheres, domain, hole.x), hole.r, 1e-14);
  }
}

TEST(VoidFilling, NothingOverlapsAndRadiiDoNotGrow) {
  for (const auto& domain : {VoidDomain::box({{-1.0, -1.0, -1.0}}, {{1.0, 1.0, 1.0}}), VoidDomain::unit_sphere()})
    for (const double r_max : {0.12, 1.0}) {
      const auto spheres = random_spheres(domain, 80, 0.3, 3);
      VoidFillingOptions options;
      options.r_max = r_max;
      options.r_min = 0.06;
      const VoidFilling filling = fill_voids(spheres, domain, options);
      EXPECT_GT(filling.added.size(), 50U);
      EXPECT_LT(filling.next_hole, 0.06);
      expect_sound(spheres, domain, filling, 0.06, r_max);
    }
}

/// A hole larger than r_max holds several spheres that lean on each other.
TEST(VoidFilling, AnEmptyBoxIsPacked) {
  VoidFillingOptions options;
  options.r_max = 0.1;
  options.r_min = 0.09;
  const auto domain = VoidDomain::box({{0.0, 0.0, 0.0}}, {{1.0, 1.0, 1.0}});
  const VoidFilling filling = fill_voids({}, domain, options);
  expect_sound({}, domain, filling, 0.09, 0.1);
  EXPECT_GT(filling.volume, 0.36);  // random places, one sphere after another, jam at about 0.33 here
}

TEST(VoidFilling, VolumeAndCountEndIt) {
  const auto domain = VoidDomain::box({{0.0, 0.0, 0.0}}, {{1.0, 1.0, 1.0}});
  VoidFillingOptions options;
  options.r_max = 0.1;
  options.r_min = 0.05;
  options.count = 7;
  EXPECT_EQ(fill_voids({}, domain, options).added.size(), 7U);
  options.count = 100000;
  options.volume = 0.1;
  const VoidFilling filling = fill_voids({}, domain, options);
  EXPECT_GE(filling.volume, 0.1);
  EXPECT_LT(filling.volume, 0.1 + 4.2e-3);
}

/// The holes of a simple cubic lattice, none at a wall: those on the faces of the cell count once.
TEST(VoidFilling, ACellHasTheHolesOfItsLattice) {
  const auto domain = VoidDomain::cell({{0.1, -0.2, 0.0}}, {{1.1, 0.8, 1.0}});
  std::vector<PackedSphere> lattice;
  for (int k = 0; k < 27; ++k)
    lattice.push_back({{{0.1 + (k % 3) / 3.0, -0.2 + (k / 3 % 3) / 3.0, (k / 9) / 3.0}}, 1.0 / 6.0});
  VoidFillingOptions options;
  const double hole = (std::sqrt(3.0) - 1.0) / 6.0;
  options.r_min = 0.9 * hole;
  const VoidFilling filling = fill_voids(lattice, domain, options);
  ASSERT_EQ(filling.added.size(), 27U);
  for (const PackedSphere& s : filling.added) {
    EXPECT_NEAR(s.r, hole, 1e-6);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(s.x[k], domain.low[k]);
      EXPECT_LT(s.x[k], domain.high[k]);
    }
  }
}

/// Nobody overlaps across a face, and sampling finds no larger hole, where faces are or elsewhere.
TEST(VoidFilling, ACellIsFilledAcrossItsFaces) {
  const auto domain = VoidDomain::cell({}, {{1.0, 1.0, 1.0}});
  for (const std::uint64_t index : {1U, 2U}) {
    const auto spheres = random_spheres(domain, 60, 0.12, index);
    VoidFillingOptions options;
    options.r_max = 0.15;
    options.r_min = 0.05;
    const VoidFilling filling = fill_voids(spheres, domain, options);
    ASSERT_GT(filling.added.size(), 30U);
    expect_sound(spheres, domain, filling, options.r_min, options.r_max);
    std::vector<PackedSphere> all = spheres;
    all.insert(all.end(), filling.added.begin(), filling.added.end());
    RandomStream random(6, RandomPurpose::test, index);
    for (int k = 0; k < 20000; ++k) {
      const Vec3 x{{random.uniform(), random.uniform(), random.uniform()}};
      EXPECT_LT(clearance(all, domain, x), options.r_min * (1.0 + 1e-9));
    }
  }
}

TEST(VoidFilling, BadArgumentsAreNamed) {
  const auto domain = VoidDomain::box({{0.0, 0.0, 0.0}}, {{1.0, 1.0, 1.0}});
  VoidFillingOptions options;
  EXPECT_THROW(fill_voids({}, domain, options), InputError);
  options.r_min = 0.2;
  options.r_max = 0.1;
  EXPECT_THROW(fill_voids({}, domain, options), InputError);
  EXPECT_THROW(fill_voids({}, VoidDomain::box({}, {}), {0.1, 0.01}), InputError);
}

TEST(VoidFilling, HundredsOfSpheresTakeNoTime) {
  const auto domain = VoidDomain::unit_sphere();
  const auto spheres = random_spheres(domain, 300, 0.2, 9);
  const std::clock_t start = std::clock();
  VoidFillingOptions options;
  options.r_max = 0.1;
  options.r_min = 0.045;
  const VoidFilling filling = fill_voids(spheres, domain, options);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  EXPECT_GT(filling.added.size(), 300U);
  EXPECT_LT(seconds, 10.0) << filling.added.size();  // of processor time; about 1 s, with sanitizers some
  RecordProperty("seconds", std::to_string(seconds));
  RecordProperty("spheres", static_cast<int>(filling.added.size()));
}

}  // namespace
}  // namespace softgrain
