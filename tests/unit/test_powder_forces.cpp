// Pairs of a powder one by one, distributions of their forces, and what follows from a whole state.
#include "microsim/powder/powder_contacts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "common/dynamics/force_pass.h"
#include "microsim/powder/powder_analysis.h"
#include "tests/support/disks.h"

namespace softgrain {
namespace {

using test::disks_by_hand;

PowderInteraction pair_of(double n, double t, bool distant = false) {
  PowderInteraction pair;
  pair.normal_force = n;
  pair.tangential_force = t;
  pair.distant = distant;
  return pair;
}

TEST(Histogram, CountsEverythingOnce) {
  Histogram h(-1.0, 1.0, 4);
  for (const double x : {-1.0, -0.6, 0.0, 0.49, 0.5, 0.999, 1.0, -1.001, std::nan("")}) h.add(x);
  EXPECT_EQ(h.counts, (std::vector<std::int64_t>{2, 0, 2, 2}));
  EXPECT_EQ(h.below, 1);
  EXPECT_EQ(h.above, 2);
  const std::vector<double> p = h.density();
  EXPECT_NEAR(std::accumulate(p.begin(), p.end(), 0.0) * h.width(), 6.0 / 9.0, 1e-15);
  EXPECT_EQ(Histogram(0.0, 1.0, 2).density(), (std::vector<double>{0.0, 0.0}));
}

TEST(PowderForces, GoToTheirBins) {
  const std::vector<PowderInteraction> pairs{pair_of(2.0, 0.0),  pair_of(-0.5, std::sqrt(0.75)), pair_of(0.5, -0.5),
                                             pair_of(1e-5, 0.0), pair_of(-0.5, 0.0, true),       pair_of(-1.0, 0.0)};
  const PowderForces f = powder_forces(pairs, 1e-4);
  EXPECT_EQ(f.normal.total(), 6);
  EXPECT_EQ(f.normal.counts[62], 1) << "2.0";
  EXPECT_EQ(f.normal.below + f.normal.above, 0);
  EXPECT_EQ(f.ratio.total(), 4) << "stressed contacts alone";
  EXPECT_EQ(f.ratio.counts[34], 1) << "sqrt 3";
  EXPECT_EQ(f.ratio.counts[0], 2);
  EXPECT_EQ(f.angle.counts[0], 1);
  EXPECT_EQ(f.angle.counts[24] + f.angle.counts[23], 1) << "120 degrees";
  EXPECT_EQ(f.angle.counts[9] + f.angle.counts[8], 1) << "45 degrees, whatever the sign of T";
  EXPECT_EQ(f.angle.counts[35], 1) << "pulled straight";
  EXPECT_NEAR(*f.zero_share, 0.2, 1e-15) << "distant pairs left out";
  EXPECT_EQ(f.normal_over_mean.total(), 6);
  EXPECT_FALSE(powder_forces({}, 1e-4).zero_share.has_value());
  EXPECT_EQ(powder_forces({pair_of(-1.0, 0.0), pair_of(1.0, 0.0)}, 1e-4).normal_over_mean.total(), 0)
      << "no mean to divide by";
}

TEST(PowderInteractions, KnowForcesKindAndMoment) {
  PowderSpec spec;
  spec.stiffness = 1e4;
  spec.rolling = true;
  // Across the boundary: pulled; pressed; at a distance; at equilibrium.
  System<2> s = disks_by_hand(
      spec, {{{{9.6, 5.0}}}, {{{0.59995, 5.0}}}, {{{1.59965, 5.0}}}, {{{2.60015, 5.0}}}, {{{3.60005, 5.0}}}}, 10.0);
  s.particles.spin[2][0] = 0.2;
  force_pass(s, 1e-3, History::advance);
  s.particles.spin[2][0] = 0.0;
  const auto pairs = powder_interactions(s, 1e-2);
  ASSERT_EQ(pairs.size(), 4U);
  int seen = 0;
  for (const PowderInteraction& p : pairs) {
    EXPECT_NEAR(p.arm_i + p.arm_j, norm(p.branch), 1e-12);
    const bool first = p.i == 0 || p.j == 0;
    EXPECT_EQ(std::abs(winding(s, p)[0]), first ? 1.0 : 0.0);
    EXPECT_EQ(winding(s, p)[1], 0.0);
    if (first) {
      EXPECT_EQ(p.kind, ForceKind::tensile);
      EXPECT_NEAR(p.normal_force, -0.5, 1e-9);
      ++seen;
    } else if (p.distant) {
      EXPECT_EQ(p.kind, ForceKind::distant);
      EXPECT_NEAR(p.normal_force, -0.5, 1e-9);
      ++seen;
    } else if (p.i == 2 || p.j == 2) {
      EXPECT_EQ(p.kind, ForceKind::compressive);
      EXPECT_NEAR(p.normal_force, 2.0, 1e-9);
      EXPECT_NEAR(std::abs(p.rolling_moment), 1e-4 * 1e4 * 0.2e-3, 1e-12);
      EXPECT_NEAR(p.tangential_force, 1e4 * 0.2e-3 * 0.5, 2e-3) << "turns both clockwise, against the turn";
      ++seen;
    } else {
      EXPECT_EQ(p.kind, ForceKind::unstressed);
      ++seen;
    }
  }
  EXPECT_EQ(seen, 4);
}

TEST(PowderAnalysis, OfOnePairInACell) {
  PowderSpec spec;
  spec.stiffness = 1e4;
  const System<2> s = disks_by_hand(spec, {{{{5.0, 5.0}}}, {{{5.9997, 5.0}}}}, 20.0);
  const PowderAnalysis a = analyse_powder(s, spec, 0.0025, true);
  EXPECT_NEAR(*a.rumpf_ratio, 1.0, 1e-6) << "P = N d/(2 A) of one pair with N = 2";
  const double phi = 2.0 * 0.25 * M_PI / 400.0;
  EXPECT_NEAR(a.solid_fraction_3d, 0.7523 * std::pow(phi, 1.5), 1e-4 * std::pow(phi, 1.5));
  EXPECT_FALSE(a.percolation.either.has_value());
  EXPECT_EQ(a.rigidity->fixed.floppy, 4);
  EXPECT_FALSE(analyse_powder(s, spec, 0.0, false).rumpf_ratio.has_value());
  EXPECT_FALSE(analyse_powder(s, spec, 0.0, false).rigidity.has_value());
}

}  // namespace
}  // namespace softgrain
