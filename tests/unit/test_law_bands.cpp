// The 95 % bands of a fit: around the fitted curve, and in the table for whoever draws it.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "calibrate/threshold_fit.h"
#include "common/io/hdf5_file.h"

namespace softgrain {
namespace {

/// Eight packings of Fn = E Rs^2 s (Delta^3 - 0.1^3), s different for each.
Measurements scattered_measurements() {
  Measurements data;
  const double unit = data.spec.youngs_modulus * data.spec.shell_radius * data.spec.shell_radius;
  for (int k = 0; k < 8; ++k) {
    data.packings.emplace_back();
    PackingRun run;
    run.packing = k;
    run.relaxation = "damped";
    for (int p = 1; p <= 12; ++p) {
      const double d = 0.025 * p;
      const double value = d > 0.1 ? (0.8 + 0.05 * k) * (std::pow(d, 3.0) - std::pow(0.1, 3.0)) : 0.0;
      run.normal.push_back({d, unit * value, 0.0, 0.1, true});
    }
    data.runs.push_back(run);
  }
  return data;
}

TEST(LawBands, HoldTheFittedCurveAndAreWrittenToTheTable) {
  const LawCard card = calibrate(scattered_measurements());
  ASSERT_EQ(card.pairs.size(), 1u);
  const PairLaw& law = card.pairs[0];
  ASSERT_FALSE(law.bands.empty());
  ASSERT_EQ(law.bands[0].law, "normal");
  for (std::size_t k = 0; k < law.band_delta.size(); ++k) {
    const double value = law.normal.value(law.band_delta[k]);
    EXPECT_LE(law.bands[0].low[k], value + 1e-12);
    EXPECT_GE(law.bands[0].high[k], value - 1e-12);
  }
  // Scatter of s: 0.8 to 1.15, standard error of the mean 4.4 %; 95 % band about +-8 %.
  const double width = (law.bands[0].high.back() - law.bands[0].low.back()) / law.normal.value(law.band_delta.back());
  EXPECT_GT(width, 0.10);
  EXPECT_LT(width, 0.22);

  const std::string path = testing::TempDir() + "/law_bands.toml";
  save_card(card, path);
  const h5::Group band = h5::open_file(testing::TempDir() + "/law_bands.h5").open("band").open("soft-solid");
  EXPECT_EQ(band.doubles("delta"), law.band_delta);
  EXPECT_EQ(band.doubles("normal_low"), law.bands[0].low);
  EXPECT_EQ(band.doubles("normal_high"), law.bands[0].high);
  EXPECT_FALSE(band.has("tangential_initial_low"));
}

}  // namespace
}  // namespace softgrain
