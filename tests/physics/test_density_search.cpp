// Preparations to a density: the friction while packed is searched for each sample.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <set>

#include "common/core/particles.h"
#include "macrosim/density_search.h"
#include "macrosim/preparation.h"
#include "tests/support/temporary_directory.h"

namespace softgrain {
namespace {

/// One body that fills this share of its box.
MacroPacking packing_of_fraction(double fraction) {
  MacroPacking packing{{}, {{1.0, 1.0, 1.0}}, {{{}, std::cbrt(fraction / kSphereVolume), false}}};
  packing.cost = {10, 100, 1.0};
  return packing;
}

/// A search over a known law of the solid fraction, and the frictions that it tried.
struct KnownSearch {
  std::function<double(double)> fraction_of;
  std::vector<double> frictions{};

  MacroPacking find(const DensityTarget& target, double largest = 0.5) {
    frictions.clear();
    return pack_to_density(target, 2500.0, largest, 3, [&](double friction) {
      frictions.push_back(friction);
      return packing_of_fraction(fraction_of(friction));
    });
  }
  std::string refusal(const DensityTarget& target) {
    try {
      (void)find(target);
    } catch (const DensityNotReached& e) {
      EXPECT_EQ(e.status(), ExitStatus::not_usable);
      return e.what();
    }
    return "";
  }
};

/// As packings of many grains: 0.64 without friction, 0.58 with 0.5.
double smooth_fraction(double friction) { return 0.575 + 0.065 * std::exp(-friction / 0.2); }

TEST(DensitySearch, FindsTheFrictionOfASmoothLaw) {
  KnownSearch search{smooth_fraction};
  for (const double target : {0.585, 0.60, 0.62, 0.635}) {
    const MacroPacking packing = search.find({DensityMeasure::solid_fraction, target, 1e-4});
    ASSERT_TRUE(packing.density);
    EXPECT_NEAR(packing.solid_fraction(), target, 1e-4);
    EXPECT_NEAR(packing.density->friction, -0.2 * std::log((target - 0.575) / 0.065), 5e-3) << target;
    EXPECT_EQ(packing.density->tries, static_cast<std::int64_t>(search.frictions.size()));
    EXPECT_LE(packing.density->tries, 9) << target;
    EXPECT_EQ(packing.cost.loop_passes, 10 * packing.density->tries) << "the cost is that of all tries";
    EXPECT_EQ(packing.density->target, target);
  }
  // Coarse enough for the usual number of tries.
  (void)search.find({DensityMeasure::solid_fraction, 0.61, 1e-3});
  EXPECT_LE(search.frictions.size(), static_cast<std::size_t>(kUsualDensityTries));
}

TEST(DensitySearch, AnEndThatMeetsTheTargetIsTakenAtOnce) {
  KnownSearch search{smooth_fraction};
  EXPECT_EQ(search.find({DensityMeasure::solid_fraction, smooth_fraction(0.5) - 5e-4, 1e-3}).density->friction, 0.5);
  EXPECT_EQ(search.frictions.size(), 1U);
  EXPECT_EQ(search.find({DensityMeasure::solid_fraction, 0.6405, 1e-3}).density->friction, 0.0);
  EXPECT_EQ(search.frictions.size(), 2U);
}

TEST(DensitySearch, SaysWhatIsReachedAfterTwoTries) {
  KnownSearch search{smooth_fraction};
  const std::string loose = search.refusal({DensityMeasure::solid_fraction, 0.55, 1e-3});
  EXPECT_EQ(search.frictions, (std::vector<double>{0.5, 0.0}));
  for (const char* word : {"solid_fraction = 0.55 +- 0.001", "sample 3", "from 0.5803 with friction 0.5",
                           "to 0.6400 without", "mu_r", "more loosely"})
    EXPECT_NE(loose.find(word), std::string::npos) << word << " not in " << loose;
  const std::string dense = search.refusal({DensityMeasure::void_ratio, 0.25, 1e-3});
  EXPECT_EQ(search.frictions.size(), 2U);
  for (const char* word :
       {"void_ratio = 0.25 (solid fraction 0.8000 +- 0.001)", "void_ratio from 0.7231 to 0.5625", "more densely"})
    EXPECT_NE(dense.find(word), std::string::npos) << word << " not in " << dense;
}

/// Few grains: the fraction jumps over the target.
TEST(DensitySearch, AJumpOverTheTargetEndsAndSaysHowNearItCame) {
  KnownSearch search{[](double friction) { return friction < 0.217 ? 0.62 : 0.60; }};
  const std::string text = search.refusal({DensityMeasure::solid_fraction, 0.608, 1e-3});
  EXPECT_EQ(search.frictions.size(), static_cast<std::size_t>(kMostDensityTries));
  EXPECT_EQ(std::set<double>(search.frictions.begin(), search.frictions.end()).size(), search.frictions.size())
      << "none twice";
  for (const char* word : {"not met in 30 preparations", "0.6000", "solid_fraction_tolerance"})
    EXPECT_NE(text.find(word), std::string::npos) << word << " not in " << text;
  EXPECT_NEAR(search.find({DensityMeasure::solid_fraction, 0.608, 0.0081}).solid_fraction(), 0.60, 1e-12);
}

/// Neighbouring frictions give packings that differ by more than the tolerance: other crossings are found.
TEST(DensitySearch, MeetsTheTargetOfARoughLaw) {
  KnownSearch search{[](double friction) {
    return smooth_fraction(friction) + 0.003 * std::sin(1e4 * friction + std::sin(3e5 * friction));
  }};
  std::size_t most = 0;
  for (double target = 0.585; target < 0.635; target += 0.001) {
    EXPECT_NEAR(search.find({DensityMeasure::solid_fraction, target, 1e-3}).solid_fraction(), target, 1e-3);
    most = std::max(most, search.frictions.size());
  }
  EXPECT_LT(most, static_cast<std::size_t>(kMostDensityTries));
}

TEST(DensityTarget, IsOneDensityInThreeMeasures) {
  const DensityTarget fraction{DensityMeasure::solid_fraction, 0.625, 1e-3};
  const DensityTarget ratio{DensityMeasure::void_ratio, 0.6, 1e-3};
  const DensityTarget dry{DensityMeasure::dry_density, 1656.25, 1e-3};
  for (const DensityTarget& t : {fraction, ratio, dry}) {
    EXPECT_NEAR(t.solid_fraction(2650.0), 0.625, 1e-12);
    EXPECT_NEAR(t.measured(0.625, 2650.0), t.value, 1e-9);
  }
  EXPECT_EQ(dry.text(2650.0), "dry_density = 1656.25 kg/m^3 (solid fraction 0.6250 +- 0.001)");
}

MacroSpec grains_with_friction() {
  MacroSpec spec;
  spec.boundary = Boundary::periodic;
  spec.bodies = 150;
  spec.soft_share = 0.0;
  spec.friction = 0.5;
  spec.start_pressure = 1e-4;
  spec.preparation = Preparation::fast;
  spec.protocol = protocol_of(Preparation::fast, spec.friction);
  spec.protocol.tolerance = 3e-3;
  return spec;
}

MacroPacking grains_of_fraction(double fraction, std::uint64_t seed) {
  const MacroSpec spec = grains_with_friction();
  return pack_to_density({DensityMeasure::solid_fraction, fraction, 2e-3}, spec.density, spec.protocol.friction, 0,
                         [&](double friction) {
                           MacroSpec tried = spec;
                           tried.protocol.friction = friction;
                           return make_macro_packing(tried, seed, 0);
                         });
}

TEST(DensitySearch, PackingsOfGrainsMeetTheirTarget) {
  for (const std::uint64_t seed : {1U, 2U})
    for (const double target : {0.60, 0.63}) {
      const MacroPacking packing = grains_of_fraction(target, seed);
      EXPECT_NEAR(packing.solid_fraction(), target, 2e-3);
      EXPECT_GT(packing.density->friction, target > 0.61 ? 0.0 : 0.1);
      EXPECT_LT(packing.density->friction, target > 0.61 ? 0.2 : 0.5);
      EXPECT_FALSE(packing.springs.empty());
    }
}

TEST(DensitySearch, HasTheSameBitsForAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const MacroPacking one = grains_of_fraction(0.61, 1);
  omp_set_num_threads(3);
  const MacroPacking three = grains_of_fraction(0.61, 1);
  omp_set_num_threads(before);
  EXPECT_EQ(one.high, three.high);
  EXPECT_EQ(one.density, three.density);
  for (std::size_t k = 0; k < one.bodies.size(); ++k) EXPECT_EQ(one.bodies[k].x, three.bodies[k].x);
}

TEST(DensitySearch, IsKeptWithItsPacking) {
  const test::TemporaryDirectory directory;
  KnownSearch search{smooth_fraction};
  const MacroPacking packing = search.find({DensityMeasure::solid_fraction, 0.61, 1e-3});
  {
    h5::AtomicFile file(directory.file("packing.h5"));
    write_macro_packing(file.root().create("searched"), packing);
    write_macro_packing(file.root().create("plain"), packing_of_fraction(0.5));
    file.commit();
  }
  const h5::Group file = h5::open_file(directory.file("packing.h5"));
  EXPECT_EQ(read_macro_packing(file.open("searched")).density, packing.density);
  EXPECT_FALSE(read_macro_packing(file.open("plain")).density);
}

}  // namespace
}  // namespace softgrain
