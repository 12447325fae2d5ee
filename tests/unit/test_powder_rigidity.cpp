// Rigidity of powders: numbers known by hand, the same ranks from other factorisations, stiffness against its spectrum.
#include "microsim/powder/powder_rigidity.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <Eigen/SparseQR>
#include <cmath>

#include "common/core/random.h"
#include "tests/support/disks.h"

namespace softgrain {
namespace {

using test::disks_by_hand;
using test::HandDisk;

enum class Contact { smooth, rough, rolling };

PowderSpec spec_of(Contact contact) {
  PowderSpec spec;
  spec.stiffness = 1e4;
  spec.friction = contact == Contact::smooth ? 0.0 : 0.5;
  spec.rolling = contact == Contact::rolling;
  return spec;
}

PowderRigidity rigidity(const System<2>& s, bool cohesive = true) {
  return powder_rigidity(s, powder_interactions(s, 1e-4), cohesive);
}

void expect(const std::vector<HandDisk>& disks, Contact contact, std::int64_t h, std::int64_t k) {
  const PowderRigidity r = rigidity(disks_by_hand(spec_of(contact), disks));
  EXPECT_EQ(r.fixed.indeterminacy, h);
  EXPECT_EQ(r.fixed.floppy, k);
  EXPECT_TRUE(r.fixed.identity_holds());
  EXPECT_FALSE(r.free.has_value()) << "free space has no strains";
}

constexpr double kTouching = 0.9999;  ///< distance of two disks of diameter 1 that overlap by F0/K_N
const double kRise = kTouching * std::sqrt(0.75);

std::vector<HandDisk> chain(int n) {
  std::vector<HandDisk> out;
  for (int k = 0; k < n; ++k) out.push_back({{{kTouching * k, 0.1 * kTouching * (k % 2)}}});
  for (int k = 0; k < n; ++k) out[static_cast<std::size_t>(k)].x[0] *= std::sqrt(0.99);
  return out;
}
const std::vector<HandDisk> kTriangle{{{{0.0, 0.0}}}, {{{kTouching, 0.0}}}, {{{0.5 * kTouching, kRise}}}};
const std::vector<HandDisk> kDoubleTriangle{
    {{{0.0, 0.0}}}, {{{kTouching, 0.0}}}, {{{0.5 * kTouching, kRise}}}, {{{1.5 * kTouching, kRise}}}};
const std::vector<HandDisk> kRing{
    {{{0.0, 0.0}}}, {{{kTouching, 0.0}}}, {{{kTouching, kTouching}}}, {{{0.0, kTouching}}}};

TEST(PowderRigidity, OfFewDisksIsKnownByHand) {
  for (const int n : {2, 3, 7}) {
    expect(chain(n), Contact::rough, 0, n + 2);  // 3n - 2(n - 1): every link turns like a pair of gears
    expect(chain(n), Contact::rolling, 0, 3);    // one rigid body
    expect(chain(n), Contact::smooth, 0, n + 1);
  }
  expect(kTriangle, Contact::rough, 0, 3);  // three gears in a ring cannot turn
  expect(kTriangle, Contact::rolling, 3, 3);
  expect(kTriangle, Contact::smooth, 0, 3);
  expect(kRing, Contact::rough, 0, 4);  // four can
  expect(kRing, Contact::rolling, 3, 3);
  expect(kRing, Contact::smooth, 0, 4);  // it shears
  expect(kDoubleTriangle, Contact::rough, 1, 3);
  expect(kDoubleTriangle, Contact::smooth, 0, 3);
  expect(kDoubleTriangle, Contact::rolling, 6, 3);
}

TEST(PowderRigidity, ADistantPairHoldsOneDistance) {
  const std::vector<HandDisk> pair{{{{0.0, 0.0}}}, {{{1.0005, 0.0}}}};
  expect(pair, Contact::rough, 0, 5);
  expect(pair, Contact::rolling, 0, 5);
  expect(pair, Contact::smooth, 0, 3);
}

TEST(PowderRigidity, RollersAndRadiiOfAllSizes) {
  // Three disks of radii R1, R2, R3 that touch: as three equal ones.
  const double r1 = 0.5, r2 = 0.3, r3 = 0.25;
  const double a = r1 + r2 - 1e-4, b = r1 + r3 - 1e-4, c = r2 + r3 - 1e-4;
  const double x = (a * a + b * b - c * c) / (2.0 * a);
  expect({{{{0.0, 0.0}}, r1}, {{{a, 0.0}}, r2}, {{{x, std::sqrt(b * b - x * x)}}, r3}}, Contact::rough, 0, 3);
}

std::vector<HandDisk> square_lattice(int n, double across = kTouching) {
  std::vector<HandDisk> out;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) out.push_back({{{0.5 + kTouching * i, 0.5 + across * j}}});
  return out;
}

/// Rows and columns of a square lattice are locked by friction; only gears all turning against their neighbours are
/// free, when the period lets them: k = 3 for even n, 2 for odd.
TEST(PowderRigidity, OfThePeriodicSquareLattice) {
  for (const int n : {3, 4, 5, 6}) {
    const PowderRigidity r = rigidity(disks_by_hand(spec_of(Contact::rough), square_lattice(n), kTouching * n));
    const std::int64_t k = n % 2 == 0 ? 3 : 2;
    EXPECT_EQ(r.fixed.floppy, k) << n;
    EXPECT_EQ(r.fixed.indeterminacy, 4 * n * n + k - 3 * n * n) << n;
    ASSERT_TRUE(r.free.has_value());
    EXPECT_EQ(r.free->floppy, k) << "no strain is free";
    EXPECT_EQ(r.free->indeterminacy, r.fixed.indeterminacy - 2) << "two of its self-stresses carry a load";
    EXPECT_EQ(r.fixed.stiffness.positive, n % 2 == 1) << n;
    EXPECT_EQ(r.free->stiffness.positive, n % 2 == 1) << n;
    EXPECT_GT(r.fixed.of_matrix.smallest_kept, 1e-2);
    EXPECT_LT(r.fixed.of_matrix.largest_dropped, 1e-13);
  }
}

/// A triangular lattice with holes, its disks moved a little: some contacts open, some stay as distant pairs.
System<2> broken_lattice(Contact contact, std::uint64_t seed) {
  constexpr int kRows = 8;
  RandomStream random(seed, RandomPurpose::test, 0);
  PowderSpec spec = spec_of(contact);
  spec.range = 0.02;
  std::vector<HandDisk> disks;
  for (int j = 0; j < kRows; ++j)
    for (int i = 0; i < kRows; ++i) {
      const double dx = 0.03 * random.uniform();
      const double dy = 0.03 * random.uniform();
      const double r = 0.49 + 0.01 * random.uniform();
      if (random.uniform() > 0.2) disks.push_back({{{i + 0.5 * (j % 2) + dx, j * std::sqrt(0.75) + dy}}, r});
    }
  System<2> s = disks_by_hand(spec, disks, 1.0);
  s.cell = box_cell<2>({{kRows, kRows * std::sqrt(0.75)}}, {true, true});
  return s;
}

Eigen::MatrixXd dense(const SparseEntries& m) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(m.rows, m.columns);
  for (const auto& e : m.entries) out(e.row, e.column) += e.value;
  return out;
}

RigidityMatrix whole(const System<2>& s, bool cell_free) {
  return rigidity_matrix(powder_interactions(s, 1e-4), s,
                         std::vector<bool>(static_cast<std::size_t>(s.particles.grains), true),
                         cell_free ? CellMotions::lengths : CellMotions::none);
}

TEST(PowderRigidity, RanksAreThoseOfOtherFactorisations) {
  for (const Contact contact : {Contact::smooth, Contact::rough, Contact::rolling})
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const System<2> s = broken_lattice(contact, seed);
      for (const bool cell_free : {false, true}) {
        const RigidityMatrix m = whole(s, cell_free);
        const Eigen::MatrixXd g = dense(m.entries);
        Eigen::BDCSVD<Eigen::MatrixXd> svd(g);
        svd.setThreshold(1e-9);
        EXPECT_EQ(sparse_rank(m.entries).rank, svd.rank());
        EXPECT_EQ(sparse_rank(m.entries.transposed()).rank, svd.rank());
        Eigen::SparseMatrix<double> sparse = g.sparseView();
        Eigen::SparseQR<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>> qr;
        qr.setPivotThreshold(1e-9);
        qr.compute(sparse);
        EXPECT_EQ(qr.rank(), svd.rank());
        EXPECT_GT(m.distant, 0);
        EXPECT_GT(m.contacts, 20);
      }
    }
}

TEST(PowderRigidity, IdentitiesOfEveryVariant) {
  for (const std::uint64_t seed : {4U, 5U}) {
    const auto check = [&](Contact contact, std::int64_t per_disk, std::int64_t per_contact) {
      const System<2> s = broken_lattice(contact, seed);
      const RigidityMatrix m = whole(s, false);
      const PowderRigidity r = rigidity(s);
      const std::int64_t n = s.particles.grains;
      EXPECT_EQ(per_disk * n + r.fixed.indeterminacy, per_contact * m.contacts + m.distant + r.fixed.floppy);
      EXPECT_EQ(per_disk * n + 2 + r.free->indeterminacy, per_contact * m.contacts + m.distant + r.free->floppy);
    };
    check(Contact::rough, 3, 2);
    check(Contact::rolling, 3, 3);
    check(Contact::smooth, 2, 1);
  }
}

/// Holds against every strain, also without friction.
System<2> triangular_lattice(Contact contact) {
  std::vector<HandDisk> disks;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) disks.push_back({{{kTouching * (i + 0.5 * (j % 2)), kRise * j}}});
  System<2> s = disks_by_hand(spec_of(contact), disks, 1.0);
  s.cell = box_cell<2>({{4.0 * kTouching, 4.0 * kRise}}, {true, true});
  return s;
}

TEST(PowderRigidity, OfThePeriodicTriangularLatticeWithoutFriction) {
  const PowderRigidity r = rigidity(triangular_lattice(Contact::smooth));
  EXPECT_EQ(r.fixed.floppy, 2);
  EXPECT_EQ(r.fixed.indeterminacy, 48 + 2 - 32);
  EXPECT_TRUE(r.fixed.stiffness.positive);
  EXPECT_TRUE(r.free->stiffness.positive);
}

/// Definite or not, as the eigenvalues say, translations taken out.
TEST(PowderRigidity, DefinitenessIsThatOfTheSpectrum) {
  int positive = 0;
  int negative = 0;
  const auto check = [&](const System<2>& s, bool cell_free) {
    const RigidityMatrix m = whole(s, cell_free);
    const Eigen::MatrixXd g = dense(m.entries);
    const Eigen::Map<const Eigen::VectorXd> k(m.stiffness.data(), static_cast<Eigen::Index>(m.stiffness.size()));
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spectrum(g.transpose() * k.asDiagonal() * g);
    const double limit = 1e-9 * spectrum.eigenvalues().maxCoeff();
    int above = 0;
    for (const double e : spectrum.eigenvalues()) above += e > limit ? 1 : 0;
    const bool definite = above == spectrum.eigenvalues().size() - 2;
    EXPECT_EQ(stiffness_definiteness(m).positive, definite);
    ++(definite ? positive : negative);
  };
  for (const Contact contact : {Contact::smooth, Contact::rough, Contact::rolling})
    for (const bool cell_free : {false, true}) {
      for (const std::uint64_t seed : {1U, 2U}) check(broken_lattice(contact, seed), cell_free);
      check(disks_by_hand(spec_of(contact), square_lattice(5), kTouching * 5), cell_free);
      check(triangular_lattice(contact), cell_free);
    }
  System<2> rows = disks_by_hand(spec_of(Contact::rolling), square_lattice(5, 1.0005), 1.0);
  rows.cell = box_cell<2>({{5.0 * kTouching, 5.0 * 1.0005}}, {true, true});
  check(rows, false);  // rows that attract each other: rigid without being stable
  EXPECT_GT(positive, 0);
  EXPECT_GT(negative, 0);
}

/// Without cohesion a disk that touches nothing makes the whole floppy, but not the backbone.
TEST(PowderRigidity, BackboneLeavesRattlersOut) {
  PowderSpec spec = spec_of(Contact::rough);
  spec.cohesive = false;
  std::vector<HandDisk> disks = square_lattice(5);
  disks.push_back({{{0.5 + 0.5 * kTouching, 0.5 + 0.5 * kTouching}}, 0.1});
  const PowderRigidity r = rigidity(disks_by_hand(spec, disks, kTouching * 5), false);
  EXPECT_EQ(r.fixed.floppy, 5);
  EXPECT_FALSE(r.fixed.stiffness.positive);
  ASSERT_TRUE(r.backbone.has_value());
  EXPECT_EQ(r.backbone->floppy, 2);
  EXPECT_TRUE(r.backbone->stiffness.positive);
  EXPECT_TRUE(r.backbone_free->stiffness.positive);
  EXPECT_EQ(r.backbone->freedoms, 75);
}

TEST(SparseRank, OfProductsAndTinyColumns) {
  RandomStream random(1, RandomPurpose::test, 0);
  const auto fill = [&](Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.uniform() - 0.5; }));
  };
  const Eigen::MatrixXd product = fill(40, 6) * fill(6, 30);
  SparseEntries m;
  m.rows = 40;
  m.columns = 30;
  for (Eigen::Index r = 0; r < 40; ++r)
    for (Eigen::Index c = 0; c < 30; ++c) m.entries.push_back({r, c, std::pow(10.0, r % 7) * product(r, c)});
  EXPECT_EQ(sparse_rank(m).rank, 6) << "whatever the units of the rows";
  EXPECT_EQ(sparse_rank(m.transposed()).rank, 6);
  EXPECT_LT(sparse_rank(m).largest_dropped, 1e-12);
  EXPECT_GT(sparse_rank(m).smallest_kept, 1e-4);
  SparseEntries nearly{2, 2, {{0, 0, 1.0}, {0, 1, 1.0}, {1, 0, 1.0}, {1, 1, 1.0 + 1e-7}}};
  EXPECT_EQ(sparse_rank(nearly).rank, 2);
  nearly.entries[3].value = 1.0 + 1e-13;
  EXPECT_EQ(sparse_rank(nearly).rank, 1);
  EXPECT_EQ(sparse_rank({3, 4, {}}).rank, 0);
}

/// 1 on the diagonal, -2 beside it: no diagonal of R is small, but the smallest singular value is about 2^-n.
TEST(SparseRank, FindsADependenceThatNoDiagonalShows) {
  SparseEntries chain;
  chain.rows = chain.columns = 60;
  for (std::int64_t k = 0; k < 60; ++k) {
    chain.entries.push_back({k, k, 1.0});
    if (k > 0) chain.entries.push_back({k - 1, k, -2.0});
  }
  for (const SparseEntries& m : {chain, chain.transposed()}) {
    const SparseRank r = sparse_rank(m);
    EXPECT_EQ(r.rank, 59);
    EXPECT_GT(r.smallest_kept, 0.1);
    EXPECT_LT(r.largest_dropped, 1e-12);
  }
  EXPECT_GT(sparse_rank(chain).factorisations, 1);
}

}  // namespace
}  // namespace softgrain
