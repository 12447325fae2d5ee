// Density field, scattered intensity and holes of disks, against closed forms and brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <queue>

#include "common/core/error.h"
#include "common/core/random.h"
#include "microsim/powder/powder_holes.h"
#include "microsim/powder/powder_mesh.h"

namespace softgrain {
namespace {

constexpr double kPi = std::numbers::pi;
using Disks = std::vector<Sphere<2>>;

double solid_area(const PowderMesh& mesh) {
  const Vec<2> d = mesh.spacing();
  return d[0] * d[1] * std::accumulate(mesh.solid.begin(), mesh.solid.end(), 0.0);
}

/// [2 J1(x)/x]^2
double form_factor(double x) { return x == 0.0 ? 1.0 : std::pow(2.0 * std::cyl_bessel_j(1.0, x) / x, 2); }

TEST(PowderMesh, SmoothNumbersHaveSmallPrimeFactors) {
  EXPECT_EQ(smooth_number(1), 2);
  EXPECT_EQ(smooth_number(11), 12);
  EXPECT_EQ(smooth_number(4200), 4200);
  EXPECT_EQ(smooth_number(4201), 4320);
}

TEST(PowderMesh, AreaIsThatOfTheDisksWhereverTheyAre) {
  const PowderMesh mesh = powder_mesh(Disks{{{{0.1, 2.95}}, 0.5}, {{{-6.2, 11.2}}, 0.4}}, {{4.0, 3.0}});
  EXPECT_GE(mesh.nx, 400);
  EXPECT_GE(mesh.ny, 300);
  EXPECT_NEAR(solid_area(mesh), kPi * (0.25 + 0.16), 2e-3);
  EXPECT_THROW((void)powder_mesh(Disks{}, {{4.0, 0.0}}), InputError);
}

TEST(PowderMesh, ADiskWiderThanThePeriodFillsItsRows) {
  const PowderMesh mesh = powder_mesh(Disks{{{{0.3, 1.0}}, 0.8}}, {{1.0, 2.0}}, 50.0);
  EXPECT_TRUE(std::all_of(mesh.solid.begin() + (mesh.ny / 2) * mesh.nx,
                          mesh.solid.begin() + (mesh.ny / 2 + 1) * mesh.nx, [](auto c) { return c == 1; }));
}

/// I(k) = (pi R^2)^2 [2 J1(kR)/(kR)]^2/A. The disk is large against the mesh, its zero sharp in narrow bins.
TEST(PowderScattering, OneDiskScattersItsFormFactorAndItsFirstZero) {
  const double r = 0.5;
  const Vec<2> lengths{{40.0, 40.0}};
  const PowderMesh mesh = powder_mesh(Disks{{{{11.3, 7.7}}, r}}, lengths, 100.0);
  std::vector<double> edges;
  for (double k = 0.05; k < 12.0; k += 0.02) edges.push_back(k);
  const ScatteringCurve curve = powder_scattering(mesh, edges);
  const double forward = std::pow(kPi * r * r, 2) / 1600.0;
  double zero = 0.0;
  double least = 1.0;
  for (std::size_t n = 0; n < curve.size(); ++n) {
    EXPECT_NEAR(curve.intensity[n] / forward, form_factor(curve.k[n] * r), 2e-3) << curve.k[n];
    if (curve.intensity[n] < least) least = curve.intensity[n], zero = curve.k[n] * r;
  }
  EXPECT_NEAR(zero, 3.831706, 0.01);  // half a bin; the mesh shifts it by 1e-3 or less (next test)
  EXPECT_LT(least / forward, 1e-5);
}

/// The zero between modes: chi_hat is real for a disk centred on a corner of the mesh, and changes its sign there.
TEST(PowderScattering, FirstZeroOfADiskIsThatOfTheBesselFunctionToTheMesh) {
  for (const double fineness : {100.0, 400.0}) {
    const PowderMesh mesh = powder_mesh(Disks{{{{1.0, 1.0}}, 0.5}}, {{2.0, 2.0}}, fineness);
    const Vec<2> d = mesh.spacing();
    const auto transform = [&](double k) {
      double sum = 0.0;
      for (std::int64_t j = 0; j < mesh.ny; ++j)
        for (std::int64_t i = 0; i < mesh.nx; ++i)
          if (mesh.solid[static_cast<std::size_t>(j * mesh.nx + i)] != 0)
            sum += std::cos(k * ((static_cast<double>(i) + 0.5) * d[0] - 1.0));
      return sum * d[0] * d[1];
    };
    double low = 7.0;
    double high = 8.3;
    for (int n = 0; n < 40; ++n) (transform(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
    EXPECT_NEAR(0.5 * low, 3.831706, 5e-4) << fineness;
  }
}

/// sum_k I(k) = area of the solid, k = 0 included: nothing is lost or counted twice, whatever the parity of the mesh.
TEST(PowderScattering, ParsevalHoldsForEvenAndOddMeshes) {
  for (const Vec<2>& lengths : {Vec<2>{{3.0, 2.4}}, Vec<2>{{2.7, 2.5}}, Vec<2>{{2.5, 2.7}}}) {
    const PowderMesh mesh = powder_mesh(Disks{{{{0.4, 0.9}}, 0.5}, {{{1.8, 1.1}}, 0.31}}, lengths, 10.0);
    const std::vector<double> edges{1e-6, 3.0, 10.0, 1e6};
    const ScatteringCurve curve = powder_scattering(mesh, edges);
    double sum = 0.0;
    double modes = 0.0;
    for (std::size_t n = 0; n < curve.size(); ++n) sum += 2.0 * curve.modes[n] * curve.intensity[n];
    for (const double m : curve.modes) modes += 2.0 * m;
    const double area = solid_area(mesh);
    EXPECT_NEAR(modes, static_cast<double>(mesh.nx * mesh.ny - 1), 1e-9);
    EXPECT_NEAR(sum + area * area / (lengths[0] * lengths[1]), area, 1e-12);
  }
}

TEST(PowderScattering, EqualsTheDirectSumOnATinyMesh) {
  const Vec<2> lengths{{1.4, 1.0}};
  const PowderMesh mesh = powder_mesh(Disks{{{{0.3, 0.4}}, 0.25}, {{{1.1, 0.7}}, 0.2}}, lengths, 10.0);
  const std::vector<double> edges{3.0, 7.0, 13.0, 20.0};
  std::vector<double> sum(3, 0.0);
  std::vector<double> count(3, 0.0);
  const Vec<2> d = mesh.spacing();
  for (std::int64_t q = -mesh.ny / 2 + 1; q < mesh.ny / 2; ++q)
    for (std::int64_t p = -mesh.nx / 2 + 1; p < mesh.nx / 2; ++p) {
      const double kx = 2.0 * kPi * static_cast<double>(p) / lengths[0];
      const double ky = 2.0 * kPi * static_cast<double>(q) / lengths[1];
      std::complex<double> hat = 0.0;
      for (std::int64_t j = 0; j < mesh.ny; ++j)
        for (std::int64_t i = 0; i < mesh.nx; ++i)
          if (mesh.solid[static_cast<std::size_t>(j * mesh.nx + i)] != 0)
            hat += std::polar(d[0] * d[1], -kx * static_cast<double>(i) * d[0] - ky * static_cast<double>(j) * d[1]);
      const double k = std::hypot(kx, ky);
      for (std::size_t b = 0; b < 3; ++b)
        if (k >= edges[b] && k < edges[b + 1]) sum[b] += std::norm(hat) / (lengths[0] * lengths[1]), ++count[b];
    }
  const ScatteringCurve curve = powder_scattering(mesh, edges);
  ASSERT_EQ(curve.size(), 3U);
  for (std::size_t b = 0; b < 3; ++b) {
    EXPECT_NEAR(curve.modes[b], 0.5 * count[b], 1e-12);
    EXPECT_NEAR(curve.intensity[b], sum[b] / count[b], 1e-13);
  }
}

/// Disks at random places scatter N times what one does: relative scatter 1/sqrt(modes).
TEST(PowderScattering, IndependentDisksAddTheirIntensities) {
  RandomStream random(7, RandomPurpose::test, 1);
  Disks disks;
  const double edge = 60.0;
  while (disks.size() < 60) {
    const Vec<2> at{{edge * random.uniform(), edge * random.uniform()}};
    disks.push_back({at, 0.5});
  }
  const PowderMesh mesh = powder_mesh(disks, {{edge, edge}}, 20.0);
  const ScatteringCurve curve = powder_scattering(mesh, scattering_bins(2.0 * kPi / edge, 5.0, 0.2));
  const double one = std::pow(kPi * 0.25, 2) / (edge * edge);
  double chi2 = 0.0;
  for (std::size_t n = 0; n < curve.size(); ++n) {
    const double expected = 60.0 * one * form_factor(0.5 * curve.k[n]);
    chi2 += curve.modes[n] * std::pow(curve.intensity[n] / expected - 1.0, 2);
  }
  const auto n = static_cast<double>(curve.size());
  EXPECT_NEAR(chi2, n, 4.0 * std::sqrt(2.0 * n));
}

TEST(PowderScattering, BinsRiseAndBadOnesAreRefused) {
  const auto edges = scattering_bins(0.15, 100.0);
  EXPECT_TRUE(std::is_sorted(edges.begin(), edges.end()));
  EXPECT_DOUBLE_EQ(edges[0], 0.075);
  EXPECT_DOUBLE_EQ(edges[1], 0.225);
  EXPECT_GE(edges.back(), 100.0);
  EXPECT_THROW((void)scattering_bins(0.0, 1.0), InputError);
  EXPECT_THROW((void)scattering_bins(1.0, 0.5), InputError);
}

/// Solid where the disks are void and the other way round.
PowderMesh inverted(PowderMesh mesh) {
  for (auto& c : mesh.solid) c = 1 - c;
  return mesh;
}

TEST(PowderHoles, DisksOfVoidHaveTheirRadii) {
  // The second lies across a corner of the period.
  const PowderMesh mesh = inverted(powder_mesh(Disks{{{{2.0, 1.5}}, 0.8}, {{{3.9, 2.95}}, 0.4}}, {{4.0, 3.0}}));
  const PowderHoles holes = powder_holes(mesh);
  ASSERT_EQ(holes.count, 2);
  EXPECT_NEAR(holes.holes[0].radius, 0.8, 1e-3);
  EXPECT_NEAR(holes.holes[1].radius, 0.4, 1e-3);
  EXPECT_NEAR(holes.holes[1].centre[0], 3.9, 1e-3);
  EXPECT_NEAR(holes.holes[1].centre[1], 2.95, 1e-3);
  EXPECT_NEAR(holes.mean_radius, (0.64 * 0.8 + 0.16 * 0.4) / 0.8, 1e-3);
  EXPECT_NEAR(holes.largest_share, 0.8, 1e-3);
  EXPECT_NEAR(holes.void_fraction, kPi * 0.8 / 12.0, 1e-3);
  EXPECT_EQ(holes.percolating, 0);
}

TEST(PowderHoles, AVoidAroundThePeriodHasNoRadius) {
  const PowderMesh lonely = powder_mesh(Disks{{{{1.0, 1.0}}, 0.5}}, {{3.0, 3.0}}, 20.0);
  const PowderHoles around = powder_holes(lonely);
  EXPECT_EQ(around.count, 1);
  EXPECT_EQ(around.percolating, 1);
  EXPECT_TRUE(std::isnan(around.mean_radius));
  EXPECT_TRUE(std::isnan(around.largest_radius));
  // A wall along x leaves a void that closes on itself along x only.
  PowderMesh channel = lonely;
  std::fill(channel.solid.begin(), channel.solid.begin() + channel.nx, std::uint8_t{1});
  EXPECT_EQ(powder_holes(channel).percolating, 1);
  // A second along y closes it.
  for (std::int64_t j = 0; j < channel.ny; ++j) channel.solid[static_cast<std::size_t>(j * channel.nx)] = 1;
  EXPECT_EQ(powder_holes(channel).percolating, 0);
  EXPECT_EQ(powder_holes(channel).count, 1);
}

TEST(PowderHoles, NoVoidNoHole) {
  PowderMesh full = powder_mesh(Disks{}, {{1.0, 1.0}}, 10.0);
  std::fill(full.solid.begin(), full.solid.end(), std::uint8_t{1});
  const PowderHoles none = powder_holes(full);
  EXPECT_EQ(none.count, 0);
  EXPECT_EQ(none.void_fraction, 0.0);
  EXPECT_EQ(none.mean_radius, 0.0);
}

/// Flood fill that carries unwrapped coordinates: the oracle of the runs.
struct Flooded {
  std::int64_t cells = 0;
  bool percolates = false;
  double radius = 0.0;
};

std::vector<Flooded> flood(const PowderMesh& mesh) {
  struct At {
    std::int64_t x, y;
  };
  std::vector<bool> seen(mesh.solid.size(), false);
  std::vector<At> where(mesh.solid.size());
  const auto cell = [&](std::int64_t x, std::int64_t y) {
    return static_cast<std::size_t>(((y % mesh.ny + mesh.ny) % mesh.ny) * mesh.nx + (x % mesh.nx + mesh.nx) % mesh.nx);
  };
  std::vector<Flooded> out;
  for (std::int64_t start = 0; start < mesh.nx * mesh.ny; ++start) {
    if (seen[static_cast<std::size_t>(start)] || mesh.solid[static_cast<std::size_t>(start)] != 0) continue;
    Flooded hole;
    std::vector<At> members;
    std::queue<At> todo;
    const At first{start % mesh.nx, start / mesh.nx};
    todo.push(first);
    seen[static_cast<std::size_t>(start)] = true;
    where[static_cast<std::size_t>(start)] = first;
    while (!todo.empty()) {
      const At at = todo.front();
      todo.pop();
      members.push_back(at);
      for (const At step : {At{1, 0}, At{-1, 0}, At{0, 1}, At{0, -1}}) {
        const At next{at.x + step.x, at.y + step.y};
        const std::size_t c = cell(next.x, next.y);
        if (mesh.solid[c] != 0) continue;
        if (seen[c]) {
          hole.percolates = hole.percolates || where[c].x != next.x || where[c].y != next.y;
          continue;
        }
        seen[c] = true;
        where[c] = next;
        todo.push(next);
      }
    }
    hole.cells = static_cast<std::int64_t>(members.size());
    const Vec<2> d = mesh.spacing();
    Vec<2> mean{};
    for (const At& m : members)
      mean += Vec<2>{{static_cast<double>(m.x) * d[0], static_cast<double>(m.y) * d[1]}} *
              (1.0 / static_cast<double>(members.size()));
    double square = (d[0] * d[0] + d[1] * d[1]) / 12.0;
    for (const At& m : members)
      square += norm2(Vec<2>{{static_cast<double>(m.x) * d[0], static_cast<double>(m.y) * d[1]}} - mean) /
                static_cast<double>(members.size());
    hole.radius = std::sqrt(2.0 * square);
    out.push_back(hole);
  }
  std::stable_sort(out.begin(), out.end(), [](const Flooded& a, const Flooded& b) { return a.cells > b.cells; });
  return out;
}

TEST(PowderHoles, EqualAFloodFillOnRandomMeshes) {
  for (std::uint64_t trial = 0; trial < 60; ++trial) {
    RandomStream random(11, RandomPurpose::test, trial);
    PowderMesh mesh;
    mesh.nx = 7 + static_cast<std::int64_t>(random.below(30));
    mesh.ny = 5 + static_cast<std::int64_t>(random.below(30));
    mesh.lengths = {{0.1 * static_cast<double>(mesh.nx), 0.13 * static_cast<double>(mesh.ny)}};
    mesh.solid.resize(static_cast<std::size_t>(mesh.nx * mesh.ny));
    const double share = 0.2 + 0.5 * random.uniform();  // about the threshold of percolation
    for (auto& c : mesh.solid) c = random.uniform() < share ? 1 : 0;
    const auto expected = flood(mesh);
    const PowderHoles holes = powder_holes(mesh);
    ASSERT_EQ(holes.holes.size(), expected.size()) << trial;
    std::vector<double> radii;
    std::vector<double> oracle;
    std::int64_t percolating = 0;
    const double cell = mesh.spacing()[0] * mesh.spacing()[1];
    for (std::size_t n = 0; n < expected.size(); ++n) {
      EXPECT_NEAR(holes.holes[n].area, cell * static_cast<double>(expected[n].cells), 1e-9);
      percolating += expected[n].percolates ? 1 : 0;
      if (!expected[n].percolates) oracle.push_back(expected[n].radius);
      if (!holes.holes[n].percolates) radii.push_back(holes.holes[n].radius);
    }
    EXPECT_EQ(holes.percolating, percolating) << trial;
    ASSERT_EQ(radii.size(), oracle.size());
    std::sort(radii.begin(), radii.end());
    std::sort(oracle.begin(), oracle.end());
    for (std::size_t n = 0; n < radii.size(); ++n) EXPECT_NEAR(radii[n], oracle[n], 1e-9) << trial;
  }
}

ContactRecord<2> contact(Slot i, Slot j, const Disks& disks) {
  ContactRecord<2> c;
  c.i = i;
  c.j = j;
  c.branch = disks[static_cast<std::size_t>(i)].x - disks[static_cast<std::size_t>(j)].x;
  return c;
}

/// Three disks at a distance `gap`, turned by `angle`, about the corner of the period.
Disks triangle(double gap, double angle) {
  const double side = 1.0 + gap;
  Disks disks;
  for (int n = 0; n < 3; ++n) {
    const double at = angle + 2.0 * kPi * n / 3.0;
    disks.push_back({{{side / std::sqrt(3.0) * std::cos(at), side / std::sqrt(3.0) * std::sin(at)}}, 0.5});
  }
  return disks;
}

/// In every direction, touching or a distant pair: the cusp hole has its area, (sqrt 3 - pi/2) r^2.
TEST(PowderHoles, ThreeTouchingDisksEncloseAHole) {
  for (const double gap : {-1e-5, 0.0, 1e-3})
    for (int turn = 0; turn < 24; ++turn) {
      const Disks disks = triangle(gap, 0.05 + 2.0 * kPi * turn / 24.0);
      PowderMesh mesh = powder_mesh(disks, {{4.0, 4.0}});
      close_contacts(mesh, disks,
                     std::vector<ContactRecord<2>>{contact(0, 1, disks), contact(1, 2, disks), contact(2, 0, disks)});
      const PowderHoles holes = powder_holes(mesh, 0.5 * smallest_hole_area(0.5));
      ASSERT_EQ(holes.count, 2) << gap << " " << turn;
      EXPECT_NEAR(holes.holes[1].area, smallest_hole_area(0.5), 0.05 * smallest_hole_area(0.5));
      EXPECT_EQ(holes.percolating, 1);
    }
}

/// Nine touching disks on a square lattice that fills the period: nine holes of (1 - pi/4) d^2, some across it.
TEST(PowderHoles, ALatticeHasOneHolePerDisk) {
  Disks disks;
  std::vector<ContactRecord<2>> contacts;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      const auto at = static_cast<Slot>(disks.size());
      disks.push_back({{{0.2 + i, 0.7 + j}}, 0.5});
      ContactRecord<2> c;
      c.i = at;
      c.branch = {{-1.0, 0.0}};
      contacts.push_back(c);
      c.branch = {{0.0, -1.0}};
      contacts.push_back(c);
    }
  PowderMesh mesh = powder_mesh(disks, {{3.0, 3.0}});
  close_contacts(mesh, disks, contacts);
  const PowderHoles holes = powder_holes(mesh, 0.5 * smallest_hole_area(0.5));
  EXPECT_EQ(holes.count, 9);
  EXPECT_EQ(holes.percolating, 0);
  for (std::size_t n = 0; n < 9; ++n) EXPECT_NEAR(holes.holes[n].area, 1.0 - kPi / 4.0, 0.01);
}

/// A contact along a row of cells: without the wall the mesh leaks through it.
TEST(PowderHoles, AContactAlongARowLeaksWithoutItsWall) {
  const double y = 2.005;  // between the centres of two cells of a mesh of 0.01: a whole row lies in the gap
  Disks disks{{{{2.0, y - 0.5005}}, 0.5}, {{{2.0, y + 0.5005}}, 0.5}};
  PowderMesh mesh = powder_mesh(disks, {{4.0, 4.0}});
  const auto row = static_cast<std::int64_t>(y / mesh.spacing()[1]);
  const auto open = [&] {
    const auto begin = mesh.solid.begin() + row * mesh.nx;
    return std::count(begin, begin + mesh.nx, 0) == mesh.nx;
  };
  EXPECT_TRUE(open());
  close_contacts(mesh, disks, std::vector<ContactRecord<2>>{contact(0, 1, disks)});
  EXPECT_FALSE(open());
}

}  // namespace
}  // namespace softgrain
