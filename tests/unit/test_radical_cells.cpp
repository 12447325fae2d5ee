// Radical Voronoi cells against polyhedra that are clipped by every half-space one after the other, and closed forms.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include "common/core/error.h"
#include "common/tessellation/radical_cells.h"
#include "tests/support/random_sites.h"
#include "tests/support/refusal.h"

namespace softgrain {
namespace {

using FaceKey = std::tuple<int, int>;  // neighbour (or -1 - plane), image

/// A convex polyhedron as a list of polygons, each with the key of the half-space that made it.
struct Polyhedron {
  std::vector<std::pair<FaceKey, std::vector<Vec3>>> faces;

  static Polyhedron box(const Vec3& a, const Vec3& b) {
    Polyhedron out;
    for (int k = 0; k < 3; ++k)
      for (int side = 0; side < 2; ++side) {
        std::vector<Vec3> corners;
        for (const auto& [u, v] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
          Vec3 x;
          x[k] = side == 0 ? a[k] : b[k];
          x[(k + 1) % 3] = u == 0 ? a[(k + 1) % 3] : b[(k + 1) % 3];
          x[(k + 2) % 3] = v == 0 ? a[(k + 2) % 3] : b[(k + 2) % 3];
          corners.push_back(x);
        }
        out.faces.push_back({{-1 - 2 * k - side, 0}, corners});
      }
    return out;
  }

  /// Keeps x . n <= limit. Corners in the plane (closer than rounding) are corners of the new face too.
  void clip(const Vec3& n, double limit, FaceKey key) {
    const double slack = 1e-11 * norm(n);
    const auto height = [&](const Vec3& x) {
      const double h = dot(x, n) - limit;
      return std::abs(h) < slack ? 0.0 : h;
    };
    bool outside = false;
    for (const auto& [name, corners] : faces)
      for (const Vec3& c : corners) outside = outside || height(c) > 0.0;
    if (!outside) return;
    std::vector<Vec3> cut;
    const auto touch = [&](const Vec3& x) {
      for (const Vec3& c : cut)
        if (norm(c - x) < 1e-9) return;
      cut.push_back(x);
    };
    for (auto& [name, corners] : faces) {
      std::vector<Vec3> kept;
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const Vec3& a = corners[k];
        const Vec3& b = corners[(k + 1) % corners.size()];
        const double ha = height(a);
        const double hb = height(b);
        if (ha <= 0.0) kept.push_back(a);
        if (ha == 0.0) touch(a);
        if ((ha < 0.0 && hb > 0.0) || (ha > 0.0 && hb < 0.0)) {
          kept.push_back(a + (b - a) * (ha / (ha - hb)));
          touch(kept.back());
        }
      }
      corners = kept;
    }
    std::erase_if(faces, [](const auto& f) { return f.second.size() < 3; });
    if (cut.size() < 3) return;
    Vec3 middle;
    for (const Vec3& c : cut) middle += c * (1.0 / static_cast<double>(cut.size()));
    const Vec3 e = cut[0] - middle;
    const Vec3 f = cross(n, e) * (1.0 / norm(n));
    std::sort(cut.begin(), cut.end(), [&](const Vec3& a, const Vec3& b) {
      return std::atan2(dot(a - middle, f), dot(a - middle, e)) < std::atan2(dot(b - middle, f), dot(b - middle, e));
    });
    faces.push_back({key, cut});
  }

  /// Vector area and centroid of a polygon.
  static std::pair<Vec3, Vec3> measure(const std::vector<Vec3>& c) {
    Vec3 area;
    for (std::size_t k = 1; k + 1 < c.size(); ++k) area += cross(c[k] - c[0], c[k + 1] - c[0]) * 0.5;
    Vec3 centroid;
    const double total = norm(area);
    for (std::size_t k = 1; k + 1 < c.size() && total > 0.0; ++k)
      centroid +=
          (c[0] + c[k] + c[k + 1]) * (dot(cross(c[k] - c[0], c[k + 1] - c[0]) * 0.5, area) / (3.0 * total * total));
    return {area, centroid};
  }

  /// By the divergence theorem: a third of distance times area, with the sign of the side.
  [[nodiscard]] double volume() const {
    if (faces.empty()) return 0.0;
    const Vec3 inside = faces[0].second[0];
    double v = 0.0;
    for (const auto& [key, corners] : faces) v += std::abs(dot(measure(corners).first, corners[0] - inside)) / 3.0;
    return v;
  }
};

struct Oracle {
  double volume = 0.0;
  std::map<FaceKey, std::pair<double, Vec3>> faces;  ///< area, centroid
};

Oracle slow_cell(const std::vector<Sphere<3>>& sites, std::size_t i, const Cell<3>* cell, const PlaneBox& box) {
  Polyhedron p = Polyhedron::box(box.low, box.high);
  for (std::size_t j = 0; j < sites.size(); ++j)
    for (int image = 0; image < (cell != nullptr ? image_count<3>() : 1); ++image) {
      const Vec3 x = sites[j].x + (cell != nullptr ? cell->image_shift(image) : Vec3{});
      const Vec3 n = x - sites[i].x;
      if (norm2(n) == 0.0) continue;
      // |y - x_i|^2 - r_i^2 <= |y - x|^2 - r_j^2
      const double limit = 0.5 * (norm2(x) - norm2(sites[i].x) + sites[i].r * sites[i].r - sites[j].r * sites[j].r);
      p.clip(n, limit, {static_cast<int>(j), image});
    }
  Oracle out{p.volume(), {}};
  for (const auto& [key, corners] : p.faces) {
    const auto [area, centroid] = Polyhedron::measure(corners);
    if (norm(area) > 1e-7) out.faces[key] = {norm(area), centroid};
  }
  return out;
}

/// Every face as the oracle sees it from both sides. Spacing of order 1.
void expect_as_clipped(const std::vector<Sphere<3>>& sites, const RadicalCells& found, const Cell<3>* cell,
                       const PlaneBox& box) {
  std::vector<std::map<FaceKey, std::pair<double, Vec3>>> seen(sites.size());
  const auto shift = [&](int image) { return cell != nullptr ? cell->image_shift(image) : Vec3{}; };
  for (const CellFace& f : found.faces) {
    if (f.area < 1e-7) continue;
    const int image = cell != nullptr ? f.image : 0;
    const int back = cell != nullptr ? image_count<3>() - 1 - f.image : 0;
    EXPECT_TRUE(f.i < f.j || (f.i == f.j && f.image > home_image<3>()));
    EXPECT_LT(norm(sites[static_cast<std::size_t>(f.j)].x + shift(f.image) - sites[static_cast<std::size_t>(f.i)].x -
                   f.separation),
              1e-12);
    EXPECT_NEAR(norm(f.separation), f.distance, 1e-14);
    EXPECT_TRUE(seen[static_cast<std::size_t>(f.i)].insert({{f.j, image}, {f.area, f.centroid}}).second);
    EXPECT_TRUE(
        seen[static_cast<std::size_t>(f.j)].insert({{f.i, back}, {f.area, f.centroid - shift(f.image)}}).second);
  }
  for (const WallFace& w : found.at_walls)
    seen[static_cast<std::size_t>(w.site)][{-1 - w.plane, 0}] = {w.area, w.centroid};
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const Oracle expected = slow_cell(sites, i, cell, box);
    EXPECT_NEAR(found.volume[i], expected.volume, 1e-10) << i;
    EXPECT_EQ(seen[i].size(), expected.faces.size()) << i;
    for (const auto& [key, face] : expected.faces) {
      const auto at = seen[i].find(key);
      ASSERT_NE(at, seen[i].end()) << i << " " << std::get<0>(key) << " " << std::get<1>(key);
      EXPECT_NEAR(at->second.first, face.first, 1e-9);
      EXPECT_LT(norm(at->second.second - face.second) * face.first, 1e-9) << i;
    }
  }
}

PlaneBox around(const Cell<3>& cell) {
  const double reach = 3.0 * (norm(cell.edges[0]) + norm(cell.edges[1]) + norm(cell.edges[2]));
  return {Vec3{{-reach, -reach, -reach}}, Vec3{{reach, reach, reach}}};
}

class RadicalCellsPeriodic : public testing::TestWithParam<int> {};

TEST_P(RadicalCellsPeriodic, AgreeWithClippedHalfSpaces) {
  const int k = GetParam();
  // From one site, its own neighbour on all sides, to many; straight and sheared cells; radii over a decade.
  const int n = std::array{1, 2, 3, 5, 12, 40}[static_cast<std::size_t>(k % 6)];
  const double l = std::cbrt(static_cast<double>(n));
  const Cell<3> cell = k < 6 ? sheared_cell({{l, 1.1 * l, 0.9 * l}}, 0.0, 0.0, 0.0)
                             : sheared_cell({{l, 1.1 * l, 0.9 * l}}, 0.3 * l, -0.25 * l, 0.2 * l);
  const auto sites = random_sites(cell, n, 0.06, 0.6, static_cast<std::uint64_t>(k));
  const RadicalCells found = radical_cells(sites, cell);
  expect_as_clipped(sites, found, &cell, around(cell));
  EXPECT_TRUE(found.at_walls.empty());
}
INSTANTIATE_TEST_SUITE_P(Samples, RadicalCellsPeriodic, testing::Range(0, 12));

TEST(RadicalCells, OneLargeSphereAmongSmallOnesCutsThemFromFarAway) {
  const double l = 5.0;
  const Cell<3> cell = sheared_cell({{l, l, l}}, 0.0, 0.0, 0.0);
  auto sites = random_sites(cell, 125, 0.05, 0.3, 77);
  sites[0].r = 2.4;
  const RadicalCells found = radical_cells(sites, cell);
  expect_as_clipped(sites, found, &cell, around(cell));
  EXPECT_GT(std::count(found.volume.begin(), found.volume.end(), 0.0), 5);
  EXPECT_GT(found.volume[0], 30.0);
}

TEST(RadicalCells, BetweenPlanesAgreeWithClippedHalfSpaces) {
  for (const int n : {1, 2, 30}) {
    const double l = std::cbrt(static_cast<double>(n));
    const Cell<3> cell = sheared_cell({{l, 1.2 * l, 0.8 * l}}, 0.0, 0.0, 0.0);
    auto sites = random_sites(cell, n, 0.06, 0.6, static_cast<std::uint64_t>(100 + n));
    const Vec3 low{{-3.0, 5.0, 0.25}};
    for (auto& s : sites) s.x += low;
    const PlaneBox box{low, low + Vec3{{l, 1.2 * l, 0.8 * l}}};
    const RadicalCells found = radical_cells(sites, box);
    expect_as_clipped(sites, found, nullptr, box);
    std::array<double, 6> area{};
    for (const WallFace& w : found.at_walls) area[static_cast<std::size_t>(w.plane)] += w.area;
    for (std::size_t k = 0; k < 6; ++k)
      EXPECT_NEAR(area[k], box.volume() / (box.high[static_cast<int>(k / 2)] - box.low[static_cast<int>(k / 2)]), 1e-9);
  }
}

TEST(RadicalCells, SimpleCubicAndBodyCentredCubicAreKnown) {
  const Cell<3> cube = sheared_cell({{2.0, 2.0, 2.0}}, 0.0, 0.0, 0.0);
  const RadicalCells simple = radical_cells({{Vec3{{0.3, 0.4, 0.5}}, 0.7}}, cube);
  ASSERT_EQ(simple.faces.size(), 3U);
  EXPECT_NEAR(simple.volume[0], 8.0, 1e-12);
  for (const CellFace& f : simple.faces) {
    EXPECT_EQ(f.i, f.j);
    EXPECT_NEAR(f.area, 4.0, 1e-12);
    EXPECT_NEAR(f.distance, 2.0, 1e-14);
  }
  // Truncated octahedra: 8 hexagons and 6 squares of edge a sqrt(2)/4.
  const RadicalCells centred = radical_cells({{Vec3{{0.3, 0.4, 0.5}}, 0.1}, {Vec3{{1.3, 1.4, 1.5}}, 0.1}}, cube);
  ASSERT_EQ(centred.faces.size(), 8U + 3U + 3U);
  const double edge = 2.0 * std::numbers::sqrt2 / 4.0;
  for (const CellFace& f : centred.faces)
    EXPECT_NEAR(f.area, f.i == f.j ? edge * edge : 1.5 * std::sqrt(3.0) * edge * edge, 1e-12);
  EXPECT_NEAR(centred.volume[0], 4.0, 1e-12);
}

TEST(RadicalCells, LatticesShearedByAWholePeriodAreTheSameCells) {
  const auto sites = random_sites(sheared_cell({{3.0, 3.0, 3.0}}, 0.0, 0.0, 0.0), 27, 0.1, 0.4, 7);
  const RadicalCells straight = radical_cells(sites, sheared_cell({{3.0, 3.0, 3.0}}, 0.0, 0.0, 0.0));
  const Cell<3> cell = sheared_cell({{3.0, 3.0, 3.0}}, 1.5, 0.0, 0.0);
  const Cell<3> mirror = sheared_cell({{3.0, 3.0, 3.0}}, -1.5, 0.0, 0.0);
  auto moved = sites;
  auto mirrored = sites;
  for (auto& s : moved) s.x = wrapped(s.x, cell);
  for (auto& s : mirrored) s.x = wrapped(s.x, mirror);
  const RadicalCells a = radical_cells(moved, cell);
  const RadicalCells b = radical_cells(mirrored, mirror);
  double largest = 0.0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    EXPECT_NEAR(a.volume[i], b.volume[i], 1e-12);
    largest = std::max(largest, std::abs(a.volume[i] - straight.volume[i]));
  }
  EXPECT_EQ(a.faces.size(), b.faces.size());
  EXPECT_GT(largest, 0.05);  // the sheared lattice is another one
}

TEST(RadicalCells, AMoveAcrossTheBoundaryChangesNoCell) {
  const Cell<3> cell = sheared_cell({{3.0, 3.2, 2.9}}, 0.7, -0.4, 0.5);
  const auto sites = random_sites(cell, 30, 0.1, 0.6, 21);
  const RadicalCells found = radical_cells(sites, cell);
  const Vec3 move{{1.9, -2.3, 0.8}};
  auto moved = sites;
  for (auto& s : moved) s.x = wrapped(s.x + move, cell);
  const RadicalCells again = radical_cells(moved, cell);
  std::multiset<std::tuple<int, int, long>> here;
  std::multiset<std::tuple<int, int, long>> there;
  for (const CellFace& f : found.faces)
    if (f.area > 1e-6) here.insert({f.i, f.j, std::lround(f.area * 1e8)});
  for (const CellFace& f : again.faces)
    if (f.area > 1e-6) there.insert({f.i, f.j, std::lround(f.area * 1e8)});
  EXPECT_EQ(here, there);
  for (std::size_t i = 0; i < sites.size(); ++i) EXPECT_NEAR(found.volume[i], again.volume[i], 1e-11);
}

/// dV_i/dx_j = A/d (x_j - c) [physics of the cell law], summed over the faces of the pair; dV_i/dx_i follows from all.
TEST(RadicalCells, VolumesChangeWithPlacesAsTheFacesSay) {
  const Cell<3> cell = sheared_cell({{2.2, 2.0, 1.9}}, 0.3, 0.2, -0.4);
  const auto sites = random_sites(cell, 9, 0.1, 0.6, 33, 0.5);
  const RadicalCells found = radical_cells(sites, cell);
  const double h = 1e-5;
  for (std::size_t j = 0; j < sites.size(); ++j) {
    std::vector<Vec3> slope(sites.size());
    for (const CellFace& f : found.faces) {
      const double share = f.area / f.distance;
      const auto a = static_cast<std::size_t>(f.i);
      const auto b = static_cast<std::size_t>(f.j);
      if (a == b) continue;  // an image of its own moves along: the two ends cancel
      const Vec3 upper = (sites[a].x + f.separation - f.centroid) * share;  // the end j moves
      const Vec3 lower = (sites[a].x - f.centroid) * share;                 // the end i moves
      if (b == j) {
        slope[a] += upper;
        slope[j] -= upper;
      }
      if (a == j) {
        slope[b] += lower;
        slope[j] -= lower;
      }
    }
    for (int k = 0; k < 3; ++k) {
      auto moved = sites;
      moved[j].x[k] += h;
      for (auto& s : moved) s.x = wrapped(s.x, cell);
      const RadicalCells up = radical_cells(moved, cell);
      moved = sites;
      moved[j].x[k] -= h;
      for (auto& s : moved) s.x = wrapped(s.x, cell);
      const RadicalCells down = radical_cells(moved, cell);
      for (std::size_t i = 0; i < sites.size(); ++i)
        EXPECT_NEAR((up.volume[i] - down.volume[i]) / (2.0 * h), slope[i][k], 1e-7) << i << " " << j << " " << k;
    }
  }
}

TEST(RadicalCells, ASmallSphereWithinALargeOneHasNoCell) {
  const Cell<3> cell = sheared_cell({{2.0, 2.0, 2.0}}, 0.0, 0.0, 0.0);
  const std::vector<Sphere<3>> sites{{Vec3{{1.0, 1.0, 1.0}}, 0.9}, {Vec3{{1.1, 1.0, 1.0}}, 0.01}};
  const RadicalCells found = radical_cells(sites, cell);
  EXPECT_EQ(found.volume[1], 0.0);
  EXPECT_NEAR(found.volume[0], 8.0, 1e-12);
  for (const CellFace& f : found.faces) EXPECT_EQ(f.i + f.j, 0);
}

TEST(RadicalCells, UnitsOfLengthDoNotMatter) {
  const double micro = 3e-6;
  const Cell<3> cell = sheared_cell({{3.0, 3.2, 2.9}}, 0.7, -0.4, 0.5);
  auto small_cell = cell;
  auto sites = random_sites(cell, 30, 0.1, 0.6, 21);
  const RadicalCells found = radical_cells(sites, cell);
  for (int k = 0; k < 3; ++k) small_cell.edges[k] *= micro;
  for (auto& s : sites) s = {s.x * micro, s.r * micro};
  const RadicalCells again = radical_cells(sites, small_cell);
  ASSERT_EQ(found.faces.size(), again.faces.size());
  for (std::size_t k = 0; k < found.faces.size(); ++k)
    EXPECT_NEAR(again.faces[k].area / (micro * micro), found.faces[k].area, 1e-10);
}

/// So many that several threads join them.
TEST(RadicalCells, AreTheSameBitsForAnyNumberOfThreads) {
  const Cell<3> cell = sheared_cell({{9.0, 9.0, 9.0}}, 1.7, -0.4, 0.5);
  const Cell<3> cube = sheared_cell({{9.0, 9.0, 9.0}}, 0.0, 0.0, 0.0);
  const auto sites = random_sites(cell, 700, 0.1, 0.6, 5);
  const auto between = random_sites(cube, 700, 0.1, 0.6, 6);
  const PlaneBox box{{}, {{9.0, 9.0, 9.0}}};
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const RadicalCells one = radical_cells(sites, cell);
  const RadicalCells walled = radical_cells(between, box);
  for (const int threads : {2, 3, 5, 8}) {
    omp_set_num_threads(threads);
    const RadicalCells many = radical_cells(sites, cell);
    EXPECT_EQ(one.volume, many.volume) << threads;
    EXPECT_TRUE(one.faces == many.faces) << threads;
    const RadicalCells walled_too = radical_cells(between, box);
    EXPECT_TRUE(walled.faces == walled_too.faces) << threads;
    EXPECT_TRUE(walled.at_walls == walled_too.at_walls) << threads;
  }
  omp_set_num_threads(before);
  EXPECT_TRUE(std::is_sorted(one.faces.begin(), one.faces.end(), [](const CellFace& a, const CellFace& b) {
    return std::tuple(a.i, a.j, a.image) < std::tuple(b.i, b.j, b.image);
  }));
}

TEST(RadicalCells, TellTheFirstOfSeveralFaultsOnAnyNumberOfThreads) {
  const Cell<3> cell = sheared_cell({{9.0, 9.0, 9.0}}, 0.0, 0.0, 0.0);
  auto sites = random_sites(cell, 700, 0.1, 0.6, 7);
  sites[690].x = sites[310].x;
  sites[680].x = sites[320].x;
  const int before = omp_get_max_threads();
  for (const int threads : {1, 8}) {
    omp_set_num_threads(threads);
    test::expect_refused<InputError>([&] { radical_cells(sites, cell); }, "sites 310 and 690 are at the same place");
  }
  omp_set_num_threads(before);
}

TEST(RadicalCells, RefuseWhatHasNoCellsAndSayWhy) {
  const Cell<3> cell = sheared_cell({{2.0, 2.0, 2.0}}, 0.0, 0.0, 0.0);
  const Sphere<3> a{Vec3{{0.5, 0.5, 0.5}}, 0.2};
  test::expect_refused<InputError>([&] { radical_cells({}, cell); }, "no sites");
  test::expect_refused<InputError>([&] { radical_cells({a, a}, cell); }, "sites 0 and 1 are at the same place");
  // The same place by way of the boundary.
  test::expect_refused<InputError>(
      [&] {
        radical_cells({{Vec3{{0.0, 1.0, 1.0}}, 0.1}, {Vec3{{2.0, 1.0, 1.0}}, 0.3}}, cell);
      },
      "at the same place");
  test::expect_refused<InputError>(
      [&] {
        radical_cells({a, {Vec3{{2.5, 0.0, 0.0}}, 0.1}}, cell);
      },
      "site 1 lies outside");
  test::expect_refused<InputError>(
      [&] {
        radical_cells({{Vec3{{0.5, 0.5, -0.5}}, 0.1}}, PlaneBox{{}, {{1.0, 1.0, 1.0}}});
      },
      "outside the box along axis 2");
  test::expect_refused<InputError>([&] { radical_cells({{Vec3{{0.5, NAN, 0.5}}, 0.1}}, cell); }, "numbers");
  test::expect_refused<InputError>([&] { radical_cells({{Vec3{{0.5, 0.5, 0.5}}, -0.1}}, cell); }, "radii");
  test::expect_refused<InputError>(
      [&] {
        radical_cells({a}, box_cell<3>({{1.0, 1.0, 1.0}}, {true, true, false}));
      },
      "every axis");
  test::expect_refused<InputError>([&] { radical_cells({a}, PlaneBox{{}, {{1.0, 0.0, 1.0}}}); }, "volume");
  // Sheared by more than a period.
  test::expect_refused<UnusableResult>(
      [&] {
        radical_cells({{Vec3{}, 0.1}}, sheared_cell({{1.0, 1.0, 1.0}}, 2.4, 0.0, 0.0));
      },
      "beyond the neighbouring");
}

}  // namespace
}  // namespace softgrain
