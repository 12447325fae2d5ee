// Elastic moduli of packs in the plane: lattices known by hand, other algebra, and a real deformation.
#include "microsim/powder/powder_rigidity.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "common/core/random.h"
#include "microsim/powder/rigidity_matrix.h"
#include "tests/support/disks.h"

namespace softgrain {
namespace {

using test::disks_by_hand;
using test::HandDisk;

constexpr double kStiffness = 1e4;
constexpr double kTouch = 1.0 - 1.0 / kStiffness;  ///< distance at which adhesion is balanced

PowderSpec spec_with(double friction, double kt_ratio = 1.0) {
  PowderSpec spec;
  spec.stiffness = kStiffness;
  spec.stiffness_ratio = kt_ratio;
  spec.friction = friction;
  return spec;
}

/// Rows of a triangular lattice; `missing` of its disks are left out, the others moved a little.
System<2> lattice(const PowderSpec& spec, double missing = 0.0, std::uint64_t seed = 1) {
  constexpr int kSide = 6;
  RandomStream random(seed, RandomPurpose::test, 0);
  const double rise = std::sqrt(0.75) * kTouch;
  std::vector<HandDisk> disks;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const double shift = missing > 0.0 ? 1e-5 * random.uniform() : 0.0;
      if (random.uniform() >= missing) disks.push_back({{{kTouch * (i + 0.5 * (j % 2)) + shift, rise * j}}});
    }
  System<2> s = disks_by_hand(spec, disks, 1.0);
  s.cell = box_cell<2>({{kSide * kTouch, kSide * rise}}, {true, true});
  return s;
}

/// Central springs k on a triangular lattice have B = sqrt(3)/2 k and G = sqrt(3)/4 k; tangential ones k_T add
/// sqrt(3)/4 k_T to G alone, since no disk turns.
TEST(PowderModuli, OfTheTriangularLattice) {
  for (const double ratio : {0.0, 0.5, 1.0}) {
    const System<2> s = lattice(spec_with(ratio > 0.0 ? 0.5 : 0.0, ratio > 0.0 ? ratio : 1.0));
    const auto m = powder_moduli(s, powder_interactions(s, 1e-4));
    ASSERT_TRUE(m.has_value());
    EXPECT_TRUE(m->distant);
    EXPECT_NEAR(m->bulk / kStiffness, 0.5 * std::sqrt(3.0), 1e-6) << ratio;
    EXPECT_NEAR(m->shear_axes / kStiffness, 0.25 * std::sqrt(3.0) * (1.0 + ratio), 1e-6) << ratio;
    EXPECT_NEAR(m->shear_cross / kStiffness, 0.25 * std::sqrt(3.0) * (1.0 + ratio), 1e-6) << ratio;
  }
}

/// The same numbers from a dense pseudo-inverse, with motions that nothing holds among the others.
TEST(PowderModuli, AreThoseOfThePseudoInverse) {
  for (const double friction : {0.0, 0.5})
    for (const std::uint64_t seed : {3U, 4U}) {
      const System<2> s = lattice(spec_with(friction), 0.25, seed);
      const auto pairs = powder_interactions(s, 1e-4);
      const auto m = powder_moduli(s, pairs);
      ASSERT_TRUE(m.has_value());
      const RigidityMatrix r = rigidity_matrix(
          pairs, s, std::vector<bool>(static_cast<std::size_t>(s.particles.grains), true), CellMotions::strain);
      Eigen::MatrixXd g = Eigen::MatrixXd::Zero(r.entries.rows, r.entries.columns);
      for (const auto& e : r.entries.entries) g(e.row, e.column) += e.value;
      const Eigen::Map<const Eigen::VectorXd> k(r.stiffness.data(), static_cast<Eigen::Index>(r.stiffness.size()));
      const Eigen::MatrixXd all = g.transpose() * k.asDiagonal() * g;
      const Eigen::Index n = r.disk_columns;
      const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> inverse(all.topLeftCorner(n, n));
      const Eigen::Matrix3d c =
          (all.bottomRightCorner(3, 3) - all.bottomLeftCorner(3, n) * inverse.solve(all.topRightCorner(n, 3))) /
          s.cell.volume();
      EXPECT_NEAR(m->bulk, 0.25 * (c(0, 0) + c(1, 1) + 2.0 * c(0, 1)), 1e-5 * kStiffness);
      EXPECT_NEAR(m->shear_axes, 0.25 * (c(0, 0) + c(1, 1) - 2.0 * c(0, 1)), 1e-5 * kStiffness);
      EXPECT_NEAR(m->shear_cross, c(2, 2), 1e-5 * kStiffness);
      EXPECT_LT(m->bulk, 0.5 * std::sqrt(3.0) * kStiffness) << "disks are missing";
    }
}

TEST(PowderModuli, OfNothingAreNone) {
  const System<2> free_space = disks_by_hand(spec_with(0.5), {{{{0.0, 0.0}}}, {{{kTouch, 0.0}}}});
  EXPECT_FALSE(powder_moduli(free_space, powder_interactions(free_space, 1e-4)).has_value());
  const System<2> apart = disks_by_hand(spec_with(0.5), {{{{0.0, 0.0}}}, {{{3.0, 0.0}}}}, 6.0);
  EXPECT_FALSE(powder_moduli(apart, powder_interactions(apart, 1e-4)).has_value());
}

}  // namespace
}  // namespace softgrain
