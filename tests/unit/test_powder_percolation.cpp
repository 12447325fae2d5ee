// Percolating force chains against a search through the unwrapped cell at every threshold.
#include "microsim/powder/powder_analysis.h"

#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <set>

#include "common/core/random.h"
#include "tests/support/disks.h"

namespace softgrain {
namespace {

constexpr double kEdge = 10.0;

struct Link {
  std::size_t i;
  std::size_t j;
  int x;  ///< periods from i to the image of j
  int y;
  double force;
};

PowderInteraction interaction(const System<2>& s, const Link& link) {
  PowderInteraction pair;
  pair.i = static_cast<Slot>(link.i);
  pair.j = static_cast<Slot>(link.j);
  pair.branch = s.particles.sphere[link.i].x - s.particles.sphere[link.j].x - Vec<2>{{kEdge * link.x, kEdge * link.y}};
  pair.normal_force = -0.6 * link.force;
  pair.tangential_force = 0.8 * link.force;
  return pair;
}

System<2> scattered(std::size_t disks, RandomStream& random) {
  std::vector<test::HandDisk> list;
  for (std::size_t k = 0; k < disks; ++k) list.push_back({{{kEdge * random.uniform(), kEdge * random.uniform()}}});
  return test::disks_by_hand({}, list, kEdge);
}

PowderPercolation percolation(const System<2>& s, const std::vector<Link>& links) {
  std::vector<PowderInteraction> pairs;
  for (const Link& link : links) pairs.push_back(interaction(s, link));
  return powder_percolation(s, pairs);
}

/// Whether disk `start` meets its image along x, along y, walking from image to image.
std::array<bool, 2> wraps(std::size_t start, const std::vector<Link>& links, double threshold) {
  using Place = std::array<int, 3>;
  constexpr int kFar = 6;
  const Place home{static_cast<int>(start), 0, 0};
  std::set<Place> seen{home};
  std::deque<Place> todo{home};
  std::array<bool, 2> out{};
  const auto go = [&](const Place& to) {
    if (std::abs(to[1]) > kFar || std::abs(to[2]) > kFar || !seen.insert(to).second) return;
    todo.push_back(to);
    if (to[0] != home[0]) return;
    out[0] = out[0] || to[1] != 0;
    out[1] = out[1] || to[2] != 0;
  };
  while (!todo.empty()) {
    const Place at = todo.front();
    todo.pop_front();
    for (const Link& l : links) {
      if (l.force < threshold) continue;
      if (static_cast<int>(l.i) == at[0]) go({static_cast<int>(l.j), at[1] + l.x, at[2] + l.y});
      if (static_cast<int>(l.j) == at[0]) go({static_cast<int>(l.i), at[1] - l.x, at[2] - l.y});
    }
  }
  return out;
}

PowderPercolation by_search(std::size_t disks, const std::vector<Link>& links) {
  PowderPercolation out;
  const auto raise = [](std::optional<double>& best, bool yes, double force) {
    if (yes && (!best || force > *best)) best = force;
  };
  for (const Link& at : links)
    for (std::size_t k = 0; k < disks; ++k) {
      const auto [x, y] = wraps(k, links, at.force);
      raise(out.x, x, at.force);
      raise(out.y, y, at.force);
      raise(out.either, x || y, at.force);
      raise(out.both, x && y, at.force);
    }
  return out;
}

void expect_same(const std::optional<double>& a, const std::optional<double>& b, const char* what) {
  ASSERT_EQ(a.has_value(), b.has_value()) << what;
  EXPECT_NEAR(a.value_or(0.0), b.value_or(0.0), 1e-12) << what;
}

TEST(PowderPercolation, IsThatOfASearchThroughTheUnwrappedCell) {
  RandomStream random(5, RandomPurpose::test, 0);
  int spanning = 0;
  int one_way = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t disks = 3 + static_cast<std::size_t>(4.0 * random.uniform());
    const System<2> s = scattered(disks, random);
    std::vector<Link> links;
    const auto count = static_cast<std::size_t>(2.0 + 8.0 * random.uniform());
    while (links.size() < count) {
      const auto i = static_cast<std::size_t>(static_cast<double>(disks) * random.uniform());
      const auto j = static_cast<std::size_t>(static_cast<double>(disks) * random.uniform());
      if (i == j) continue;
      const auto step = [&] { return random.uniform() < 0.6 ? 0 : (random.uniform() < 0.5 ? -1 : 1); };
      const int x = step();
      const int y = step();
      links.push_back({i, j, x, y, 0.1 + random.uniform()});
    }
    const PowderPercolation found = percolation(s, links);
    const PowderPercolation expected = by_search(disks, links);
    expect_same(found.x, expected.x, "x");
    expect_same(found.y, expected.y, "y");
    expect_same(found.either, expected.either, "either");
    expect_same(found.both, expected.both, "both");
    spanning += found.both ? 1 : 0;
    one_way += found.either && !found.both ? 1 : 0;
  }
  EXPECT_GT(spanning, 20);
  EXPECT_GT(one_way, 20);
}

/// A chain along x closes with its weakest link; the one along y belongs to other disks.
TEST(PowderPercolation, NeedsTheWeakestLinkAndOneCluster) {
  RandomStream random(6, RandomPurpose::test, 0);
  const System<2> s = scattered(6, random);
  std::vector<Link> links{{0, 1, 0, 0, 3.0}, {1, 2, 0, 0, 1.0}, {2, 0, 1, 0, 2.0},
                          {3, 4, 0, 0, 5.0}, {4, 5, 0, 1, 4.0}, {5, 3, 0, 0, 6.0}};
  PowderPercolation p = percolation(s, links);
  EXPECT_NEAR(*p.x, 1.0, 1e-12);
  EXPECT_NEAR(*p.y, 4.0, 1e-12);
  EXPECT_NEAR(*p.either, 4.0, 1e-12);
  EXPECT_FALSE(p.both.has_value());
  links.push_back({0, 5, -1, 1, 0.5});
  p = percolation(s, links);
  EXPECT_NEAR(*p.both, 0.5, 1e-12);
  links[2].x = 0;  // the ring closes on itself, not on its image
  EXPECT_FALSE(percolation(s, links).x.has_value());
}

}  // namespace
}  // namespace softgrain
