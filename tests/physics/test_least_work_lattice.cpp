// Self-similar deformation of a simple cubic lattice between planes that touch its grains, against the closed form
// [QS 2.2]. Lattices with mirror planes through centres: test_least_work_symmetry.cpp.
#include <gtest/gtest.h>

#include <iostream>

#include "tests/support/grain_packs.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr double kRadius = 1e-3;
constexpr double kModulus = 70e9;
constexpr double kPoisson = 0.2;

/// n^3 equal spheres that just touch, shaken a little so that the solver has work to do.
GrainPack cubic_lattice(int n, double shake, double friction) {
  GrainPack pack;
  RandomStream random(3, RandomPurpose::test, 0);
  for (int k = 0; k < n * n * n; ++k) {
    Vec3 x{{2.0 * (k % n) + 1.0, 2.0 * (k / n % n) + 1.0, 2.0 * (k / (n * n)) + 1.0}};
    for (int a = 0; a < 3; ++a) x[a] += shake * (random.uniform() - 0.5);
    add_grain(pack, x * kRadius, kRadius, kModulus, kPoisson);
  }
  add_box(pack, Vec3{{1.0, 1.0, 1.0}} * (2.0 * n * kRadius), 0.0);
  pack.friction = friction;
  return pack;
}

/// Stress of a cubic lattice of spheres that overlap by 2 R strain: P per (2 R)^2 of the undeformed section.
double lattice_force(double strain) {
  const double modulus = kModulus / (2.0 * (1.0 - kPoisson * kPoisson));
  return 4.0 / 3.0 * modulus * std::sqrt(0.5 * kRadius) * std::pow(2.0 * kRadius * strain, 1.5);
}

double worst_wall_error(const GrainPack& pack, int n, const Vec3& strain) {
  const std::vector<Vec3> forces = wall_forces(pack);
  double worst = 0.0;
  for (int k = 0; k < 3; ++k)
    for (const int side : {0, 1}) {
      const double force = (side == 0 ? -1.0 : 1.0) * forces[static_cast<std::size_t>(2 * k + side)][k];
      worst = std::max(worst, std::abs(force / (n * n * lattice_force(strain[k])) - 1.0));
    }
  return worst;
}

void expect_self_similar(LeastWorkMethod method, double friction, const Vec3& strain, double shake, double tolerance) {
  constexpr int kN = 4;
  GrainPack pack = cubic_lattice(kN, shake, friction);
  LeastWorkOptions options;
  options.method = method;
  options.residual_tolerance = 5e-13;  // rounding of the positions over the overlap
  options.work_tolerance = 0.0;
  options.force_tolerance = 1e-29;
  const LeastWorkResult r = advance(pack, squeeze(pack, strain), options);
  ASSERT_TRUE(r.converged) << to_string(r.stopped_by) << " " << r.worst_residual;
  const double error = worst_wall_error(pack, kN, strain);
  std::cout << "relative error of the wall forces " << error << "\n";
  EXPECT_LT(error, tolerance);
  EXPECT_EQ(pack.contacts.size(), static_cast<std::size_t>(3 * kN * kN * (kN - 1) + 6 * kN * kN));
}

TEST(LeastWorkLattice, IsotropicCompression) {
  expect_self_similar(LeastWorkMethod::fast, 0.0, {{0.01, 0.01, 0.01}}, 1e-3, 1e-12);
  expect_self_similar(LeastWorkMethod::published, 0.0, {{0.01, 0.01, 0.01}}, 1e-4, 1e-11);
}

TEST(LeastWorkLattice, StrainsDifferPerAxis) {
  expect_self_similar(LeastWorkMethod::fast, 0.0, {{0.01, 0.015, 0.02}}, 1e-3, 1e-12);
}

TEST(LeastWorkLattice, FrictionCarriesNothingWhenNothingSlides) {
  expect_self_similar(LeastWorkMethod::fast, 0.3, {{0.01, 0.01, 0.01}}, 0.0, 1e-12);
}

}  // namespace
