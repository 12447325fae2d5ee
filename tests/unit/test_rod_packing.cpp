// Rods on a line that tell how densely spheres pack.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "calibrate/rod_packing.h"
#include "common/core/error.h"

namespace softgrain {
namespace {

TEST(RodPacking, ChordsOfEqualSpheresGoAsTheSquareOfTheirLength) {
  constexpr std::size_t kCount = 1000;
  const std::vector<double> chords = chords_of(Grading::list({0.002}), kCount);
  ASSERT_EQ(chords.size(), kCount);
  for (std::size_t k = 0; k < kCount; ++k)
    EXPECT_NEAR(chords[k], std::sqrt(1.0 - (static_cast<double>(k) + 0.5) / kCount), 1e-6);
}

/// <L> = sum of r^3 over that of r^2, times 4/3.
TEST(RodPacking, MeanChordIsFourVolumesOverTheSurface) {
  const double span = 10.0;
  const double b = 3.5;
  const Grading sizes = Grading::power_law(b, 1.0 / span, 1.0);
  const auto moment = [&](int power) { return (1.0 - std::pow(span, b - 1.0 - power)) / (power + 1.0 - b); };
  const std::vector<double> chords = chords_of(sizes, 200000);
  const double mean = std::accumulate(chords.begin(), chords.end(), 0.0) / static_cast<double>(chords.size());
  EXPECT_NEAR(2.0 * mean, 4.0 / 3.0 * moment(3) / moment(2), 1e-4);
}

TEST(RodPacking, EqualSpheresPackAsPublished) {
  EXPECT_NEAR(rod_packing(chords_of(Grading::list({1.0}), 20000), 0.7654), 0.6435, 2e-4);
}

/// Fines far smaller than the gaps fill each of them as if it were alone, up to 1 - (1 - phi)^2 where they are enough;
/// short chords of coarse spheres keep a little of it.
TEST(RodPacking, FarSmallerFinesFillTheSpaceThatCoarseSpheresLeave) {
  const double phi = 0.6435;
  const double limit = 1.0 - (1.0 - phi) * (1.0 - phi);
  const Grading sizes = Grading::classes({{1.0, 1.0, 4.0, phi / limit}, {1e-3, 1e-3, 4.0, (1.0 - phi) * phi / limit}});
  const double found = rod_packing(chords_of(sizes, 400000), 0.7654);
  EXPECT_LT(found, limit);
  EXPECT_GT(found, limit - 0.02);
}

TEST(RodPacking, WiderSpansAreDenserAndWiderGapsLooser) {
  double before = 0.0;
  for (const double span : {1.0, 2.0, 6.0, 30.0, 1000.0}) {
    const auto chords = chords_of(Grading::classes({{1.0 / span, 1.0, 3.5, 1.0}}), 5000);
    const double phi = rod_packing(chords, 1.0);
    EXPECT_GT(phi, before);
    EXPECT_LT(rod_packing(chords, 1.1), phi);
    before = phi;
  }
}

TEST(RodPacking, RefusesWhatIsNoPacking) {
  EXPECT_THROW((void)rod_packing({}, 1.0), InputError);
  EXPECT_THROW((void)rod_packing({1.0}, 0.0), InputError);
  EXPECT_THROW((void)chords_of(Grading::list({1.0}), 1), InputError);
}

}  // namespace
}  // namespace softgrain
