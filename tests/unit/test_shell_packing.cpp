// Packings inside a shell: geometry, the law of sizes before growth, growth to contact, reproducibility, solid
// fraction.
#include "microsim/shell_packing.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "common/core/error.h"
#include "common/core/random.h"
#include "common/packing/grading.h"

namespace softgrain {
namespace {

constexpr double kRounding = 1e-12;

SoftParticleSpec quick_spec() {
  SoftParticleSpec spec;
  spec.trials = 300;
  return spec;
}

double gap(const ShellPacking& p, std::size_t i, std::size_t j) {
  return norm(p.position[i] - p.position[j]) - p.radius[i] - p.radius[j];
}

double shell_gap(const ShellPacking& p, std::size_t i) { return 1.0 - norm(p.position[i]) - p.radius[i]; }

/// Smallest gap of a grain to any other or to the shell.
double nearest(const ShellPacking& p, std::size_t i) {
  double smallest = shell_gap(p, i);
  for (std::size_t j = 0; j < p.radius.size(); ++j)
    if (j != i) smallest = std::min(smallest, gap(p, i, j));
  return smallest;
}

TEST(ShellPacking, NothingOverlapsAndEveryGrainTouchesSomething) {
  for (const std::uint64_t index : {0U, 1U, 2U}) {
    const ShellPacking p = generate_shell_packing(quick_spec(), 5, index);
    ASSERT_GT(p.radius.size(), 50U);
    ASSERT_EQ(p.radius.size(), p.position.size());
    // The gap is measured after all have grown. A grain grown early may be met by a later one but never loses its own
    // contact.
    for (std::size_t i = 0; i < p.radius.size(); ++i)
      EXPECT_NEAR(nearest(p, i), 0.0, kRounding) << "grain " << i << " of packing " << index;
  }
}

/// Growth only adds, so no grain is smaller than the law's smallest.
TEST(ShellPacking, NoGrainIsSmallerThanTheLawAllows) {
  const SoftParticleSpec spec = quick_spec();
  const double rmin = spec.rmax_over_shell / spec.polydispersity;
  const ShellPacking p = generate_shell_packing(spec, 5, 0);
  for (const double r : p.radius) EXPECT_GE(r, rmin);
  for (const double r : p.radius) EXPECT_LT(r, 1.0);
}

/// Slots keep the order of drawing, largest first. Growth blurs it grain by grain, not in the mean over a tenth of all
/// grains.
TEST(ShellPacking, LargestArePlacedFirst) {
  const ShellPacking q = generate_shell_packing(quick_spec(), 5, 0);
  const std::size_t tenth = q.radius.size() / 10;
  const auto mean = [&](std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t k = begin; k < end; ++k) sum += q.radius[k] / static_cast<double>(end - begin);
    return sum;
  };
  double before = 1e9;
  for (std::size_t k = 0; k + tenth <= q.radius.size(); k += tenth) {
    const double here = mean(k, k + tenth);
    EXPECT_LT(here, 1.15 * before) << "tenth beginning at " << k;
    before = here;
  }
  EXPECT_GT(mean(0, tenth), 2.0 * mean(q.radius.size() - tenth, q.radius.size()));
}

bool same(const ShellPacking& a, const ShellPacking& b) { return a.radius == b.radius && a.position == b.position; }

TEST(ShellPacking, SeedAndIndexAloneDecide) {
  const SoftParticleSpec spec = quick_spec();
  const ShellPacking once = generate_shell_packing(spec, 5, 3);
  EXPECT_TRUE(same(once, generate_shell_packing(spec, 5, 3)));
  EXPECT_FALSE(same(once, generate_shell_packing(spec, 5, 4)));
  EXPECT_FALSE(same(once, generate_shell_packing(spec, 6, 3)));
}

TEST(ShellPacking, ThreadsDoNotMatter) {
  const SoftParticleSpec spec = quick_spec();
  std::vector<ShellPacking> serial(4);
  std::vector<ShellPacking> parallel(4);
  for (std::size_t k = 0; k < 4; ++k) serial[k] = generate_shell_packing(spec, 5, k);
#pragma omp parallel for num_threads(2) schedule(dynamic, 1)
  for (int k = 0; k < 4; ++k)
    parallel[static_cast<std::size_t>(k)] = generate_shell_packing(spec, 5, static_cast<std::uint64_t>(k));
  for (std::size_t k = 0; k < 4; ++k) EXPECT_TRUE(same(serial[k], parallel[k])) << k;
}

/// The packing is dimensionless: neither size nor stiffness of the soft particle enters.
TEST(ShellPacking, NeitherRadiusNorModulusEnters) {
  SoftParticleSpec other = quick_spec();
  other.shell_radius = 1.0;
  other.youngs_modulus = 7e10;
  other.density = 1.0;
  EXPECT_TRUE(same(generate_shell_packing(quick_spec(), 5, 0), generate_shell_packing(other, 5, 0)));
}

/// Mean of eight packings with 300 trials and beta = 3: between 0.62 and 0.70, scatter of one packing below 0.05.
TEST(ShellPacking, SolidFractionLiesInItsBand) {
  constexpr int kPackings = 8;
  double sum = 0.0;
  double squares = 0.0;
  for (int k = 0; k < kPackings; ++k) {
    const double phi = generate_shell_packing(quick_spec(), 5, static_cast<std::uint64_t>(k)).solid_fraction();
    sum += phi;
    squares += phi * phi;
  }
  const double mean = sum / kPackings;
  const double scatter = std::sqrt((squares - kPackings * mean * mean) / (kPackings - 1));
  EXPECT_GT(mean, 0.62);
  EXPECT_LT(mean, 0.70);
  EXPECT_LT(scatter, 0.05);
}

constexpr int kMany = 120;

/// Looking only where there may be room is the same law as blind trials: over 120 packings each, number of grains and
/// solid fraction agree within three standard errors, which are 1 and 0.2 %.
TEST(ShellPacking, VoidsAreTheSameLawAsTrials) {
  struct Mean {
    double sum = 0.0;
    double squares = 0.0;
    void add(double x) {
      sum += x / kMany;
      squares += x * x / kMany;
    }
    [[nodiscard]] double error2() const { return (squares - sum * sum) / (kMany - 1); }
  };
  SoftParticleSpec spec = quick_spec();
  spec.trials = 100;
  std::array<Mean, 2> grains;
  std::array<Mean, 2> fraction;
  std::array<Mean, 2> contacts;
  for (const Placement placement : {Placement::trials, Placement::voids}) {
    spec.placement = placement;
    const std::size_t at = placement == Placement::voids ? 1 : 0;
    for (std::uint64_t k = 0; k < kMany; ++k) {
      const PackingInfo info = describe(generate_shell_packing(spec, 77, k), spec);
      grains[at].add(static_cast<double>(info.grains));
      fraction[at].add(info.solid_fraction);
      contacts[at].add(info.contacts_per_grain);
    }
  }
  for (const auto& [both, bound] : {std::pair{grains, 5.0}, std::pair{fraction, 0.002}, std::pair{contacts, 0.01}}) {
    const double error = std::sqrt(both[0].error2() + both[1].error2());
    EXPECT_LT(3.0 * error, bound * 1.5);
    EXPECT_LT(std::abs(both[0].sum - both[1].sum), 3.0 * error);
  }
}

/// Every accepted place has room, and none is found where there is none.
TEST(ShellPacking, VoidsFindTheLastPlace) {
  // One grain of 0.7 in the middle: room for 0.15 all around it, and not for more.
  ShellPacking packing;
  PlacedGrains grains(packing);
  VoidPlacement voids(0.05);
  RandomStream random(3, RandomPurpose::test, 0);
  grains.add({{0.0, 0.0, 0.0}}, 0.7);
  const std::optional<Vec3> found = voids.place(grains, 0.145, 1000000, random);  // the gap to the shell is 0.3 wide
  ASSERT_TRUE(found.has_value());
  EXPECT_GE(norm(*found), 0.845);
  EXPECT_LE(norm(*found), 0.855);
  ShellPacking full;
  PlacedGrains none(full);
  VoidPlacement nowhere(0.05);
  none.add({{0.0, 0.0, 0.0}}, 0.7);
  EXPECT_FALSE(nowhere.place(none, 0.155, 1000000000, random).has_value());
}

/// More grains offered and more trials for each pack more densely.
TEST(ShellPacking, BetaAndTrialsRaiseTheSolidFraction) {
  SoftParticleSpec spec = quick_spec();
  const auto mean = [&] {
    double sum = 0.0;
    for (std::uint64_t k = 0; k < 4; ++k) sum += generate_shell_packing(spec, 5, k).solid_fraction() / 4.0;
    return sum;
  };
  const double base = mean();
  spec.trials = 1500;
  EXPECT_GT(mean(), base + 0.01);
  spec.trials = 300;
  spec.beta = 1.1;
  EXPECT_LT(mean(), base - 0.01);
}

TEST(ShellPacking, DescriptionCountsWhatIsThere) {
  const SoftParticleSpec spec = quick_spec();
  const ShellPacking p = generate_shell_packing(spec, 5, 0);
  const PackingInfo info = describe(p, spec);
  EXPECT_EQ(info.grains, static_cast<std::int64_t>(p.radius.size()));
  EXPECT_EQ(info.solid_fraction, p.solid_fraction());
  ASSERT_EQ(info.radii.size(), p.radius.size());
  for (std::size_t k = 0; k < p.radius.size(); ++k) EXPECT_EQ(info.radii[k], p.radius[k] * spec.shell_radius);
  // Every grain made one contact when it grew; two grains share one when they met each other.
  EXPECT_GE(info.contacts_per_grain, 0.5);
  EXPECT_LE(info.contacts_per_grain, 1.5);
  EXPECT_EQ(info.exponent, fit_exponent(p.radius).exponent);
}

/// A grain as large as the shell has room at the centre alone, and one trial to find it.
TEST(ShellPacking, AnEmptyPackingIsBadInput) {
  SoftParticleSpec spec = quick_spec();
  spec.rmax_over_shell = 0.999;
  spec.polydispersity = 1.001;
  spec.beta = 1.01;
  spec.trials = 1;
  EXPECT_THROW((void)generate_shell_packing(spec, 5, 0), InputError);
}

/// A single grain grows to the shell.
TEST(ShellPacking, ALonelyGrainFillsTheRoomItHas) {
  SoftParticleSpec spec = quick_spec();
  spec.rmax_over_shell = 0.7;
  spec.polydispersity = 1.001;
  spec.beta = 1.0001;
  spec.trials = 100000;
  const ShellPacking p = generate_shell_packing(spec, 5, 0);
  ASSERT_EQ(p.radius.size(), 1U);
  EXPECT_NEAR(p.radius[0], 1.0 - norm(p.position[0]), kRounding);
}

}  // namespace
}  // namespace softgrain
