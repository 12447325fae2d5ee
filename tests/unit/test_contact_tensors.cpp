// Tensors of contacts against closed forms, and the inertial number.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "common/core/histogram.h"
#include "common/dynamics/contact_tensors.h"

namespace {

using namespace softgrain;

/// The twelve neighbours of a sphere in a face-centred cubic packing.
std::vector<Vec3> fcc_directions() {
  std::vector<Vec3> out;
  const double h = 1.0 / std::sqrt(2.0);
  for (int axis = 0; axis < 3; ++axis)
    for (const double a : {-h, h})
      for (const double b : {-h, h}) {
        Vec3 n{};
        n[(axis + 1) % 3] = a;
        n[(axis + 2) % 3] = b;
        out.push_back(n);
      }
  return out;
}

TEST(ContactTensors, FabricOfACubicPackingIsIsotropic) {
  const Matrix<3> f = fabric_tensor(fcc_directions());
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) EXPECT_NEAR(f[k][l], k == l ? 1.0 / 3.0 : 0.0, 1e-15);
}

TEST(ContactTensors, FabricHasTraceOneAndIsSymmetric) {
  std::vector<Vec3> some;
  for (int k = 1; k < 40; ++k) {
    Vec3 n{{std::sin(1.7 * k), std::cos(2.3 * k), 0.2 * std::sin(0.7 * k)}};
    some.push_back(n * (1.0 / norm(n)));
  }
  const Matrix<3> f = fabric_tensor(some);
  EXPECT_NEAR(f[0][0] + f[1][1] + f[2][2], 1.0, 1e-14);
  EXPECT_EQ(f[0][2], f[2][0]);
  EXPECT_LT(f[2][2], 0.1);
  EXPECT_EQ(fabric_tensor(std::vector<Vec3>{}), Matrix<3>{});
  const Matrix<2> plane = fabric_tensor(std::vector<Vec<2>>{{{1.0, 0.0}}, {{0.0, 1.0}}});
  EXPECT_EQ(plane[0][0], 0.5);
}

TEST(ContactTensors, BranchesTimesForces) {
  ContactRecord<3> c;
  c.j = 1;
  c.normal = {{0.0, 0.0, 1.0}};
  c.branch = {{0.3, 0.0, 2.0}};
  c.normal_force = 5.0;
  c.tangential_force = {{1.0, 0.0, 0.0}};
  const Matrix<3> pair = branch_force_sum(std::vector{c}, 2);
  EXPECT_DOUBLE_EQ(pair[2][2], 10.0);
  EXPECT_DOUBLE_EQ(pair[2][0], 2.0);
  EXPECT_DOUBLE_EQ(pair[0][2], 1.5);
  const Matrix<3> plane = branch_force_sum(std::vector{c}, 1);  // the distance from it alone
  EXPECT_DOUBLE_EQ(plane[0][2], 0.0);
  EXPECT_DOUBLE_EQ(plane[2][2], 10.0);
}

TEST(ContactTensors, AsymmetryIsThatOfTheNorm) {
  Matrix<2> t;
  t[0][1] = 1.0;
  EXPECT_NEAR(asymmetry(t), std::sqrt(0.5), 1e-15);
  t[1][0] = 1.0;
  EXPECT_EQ(asymmetry(t), 0.0);
  EXPECT_EQ(asymmetry(Matrix<2>{}), 0.0);
}

TEST(ContactTensors, InertialNumberOfAKnownState) {
  // d = 1 mm, 2500 kg/m^3 under 1 kPa at 10 /s.
  EXPECT_NEAR(inertial_number(10.0, 1e-3, 2500.0, 1000.0), 1e-2 * std::sqrt(2.5), 1e-15);
  EXPECT_TRUE(std::isnan(inertial_number(10.0, 1e-3, 2500.0, 0.0)));
  Matrix<3> simple;
  simple[0][2] = -3.0;
  EXPECT_DOUBLE_EQ(shear_rate(simple), 3.0);
  Matrix<3> pure;
  pure[0][0] = 1.5;
  pure[2][2] = -1.5;
  EXPECT_DOUBLE_EQ(shear_rate(pure), 3.0);
  Matrix<3> swelling;
  for (int k = 0; k < 3; ++k) swelling[k][k] = 2.0;
  EXPECT_NEAR(shear_rate(swelling), 0.0, 1e-15);
}

TEST(ContactTensors, ForcesAreCountedOverTheirMean) {
  const auto h = force_distribution({1.0, 3.0, 2.0, 2.0, 40.0 / 5.0 - 8.0});
  ASSERT_TRUE(h);
  EXPECT_EQ(h->total(), 5);
  EXPECT_EQ(h->counts[12], 2);  // 2 over the mean of 1.6
  EXPECT_EQ(h->counts[0], 1);
  double integral = 0.0;
  for (const double p : h->density()) integral += p * h->width();
  EXPECT_NEAR(integral, 1.0, 1e-14);
  EXPECT_FALSE(force_distribution({}));
  EXPECT_FALSE(force_distribution({0.0, 0.0}));
}

}  // namespace
