// What a change of the mix does: shares that move, residuals that are shared, paired and independent errors.
#include <gtest/gtest.h>

#include <cmath>

#include "common/core/error.h"
#include "pipelines/kinds/recipe/compressible_model.h"
#include "pipelines/kinds/recipe/difference.h"
#include "pipelines/kinds/recipe/scene.h"
#include "pipelines/results/paired_summary.h"

namespace softgrain {
namespace {

TEST(MovedShare, IsTheVolumeThatHasAnotherSize) {
  const auto of = [](double share) { return Grading::classes({{1.0, 2.0, 4.0, 1.0 - share}, {0.1, 0.2, 4.0, share}}); };
  EXPECT_NEAR(moved_share(of(0.3), of(0.3)), 0.0, 1e-12);
  EXPECT_NEAR(moved_share(of(0.3), of(0.35)), 0.05, 1e-6);
  EXPECT_NEAR(moved_share(of(0.3), Grading::classes({{5.0, 6.0, 4.0, 1.0}})), 1.0, 1e-6);
  EXPECT_NEAR(moved_share(Grading::list({1.0, 2.0}), Grading::list({1.0, 2.0})), 0.0, 1e-12);
  // 1 of 9 parts of the volume against 1 of 17.
  EXPECT_NEAR(moved_share(Grading::list({1.0, 2.0}), Grading::list({1.0, 2.0, 2.0})), 1.0 / 9.0 - 1.0 / 17.0, 1e-6);
}

TEST(CommonResidual, LeavesTheDifferenceOfTheRods) {
  const PackingPair pair = with_common_residual({0.64, 0.62, 0.63, 0.615}, 0.0);
  EXPECT_NEAR(pair.a - pair.b, 0.015, 1e-12);
  EXPECT_NEAR(pair.a + pair.b, 1.26, 1e-12);  // the mean stays
  const PackingPair moved = with_common_residual({0.64, 0.62, 0.63, 0.615}, 0.002);
  EXPECT_NEAR(moved.a - moved.b, 0.017, 1e-12);
}

/// One packing in both recipes: nothing changes.
TEST(CommonResidual, OfOnePackingIsItsOwn) {
  const PackingPair pair = with_common_residual({0.64, 0.64, 0.63, 0.63}, 0.0);
  EXPECT_DOUBLE_EQ(pair.a, 0.64);
  EXPECT_DOUBLE_EQ(pair.b, 0.64);
}

TEST(PairedNumber, ErrorsOfPairsCancelWhatTheyShare) {
  // Offsets of 1 that both share, and a difference of 0.1, 0.2, 0.3.
  const PairedNumber n = paired_number("x", "Pa", {1.1, 3.2, 2.3}, {1.0, 3.0, 2.0});
  EXPECT_NEAR(n.difference, 0.2, 1e-12);
  EXPECT_NEAR(n.error, 0.1 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(n.high - n.difference, 4.302653 * n.error, 1e-6);  // Student's, two degrees
  EXPECT_GT(n.unpaired_error, 10.0 * n.error);
  EXPECT_EQ(n.pairs, 3);
  EXPECT_LT(n.over_one(), 0.15);
  EXPECT_THROW((void)paired_number("x", "", {1.0}, {1.0, 2.0}), InputError);
}

TEST(PairedNumber, OfOnePairHasNoError) {
  const PairedNumber n = paired_number("x", "", {1.0}, {2.0});
  EXPECT_DOUBLE_EQ(n.difference, -1.0);
  EXPECT_FALSE(std::isfinite(n.error));
}

TEST(PairedNumber, IndependentErrorsAddInSquares) {
  const PairedNumber n = unpaired_number("x", "", {5.0, 0.3, 0.0, 0.0}, {4.0, 0.4, 0.0, 0.0});
  EXPECT_NEAR(n.error, 0.5, 1e-12);
  EXPECT_NEAR(n.low, 1.0 - 1.959964 * 0.5, 1e-6);
  EXPECT_EQ(n.pairs, 0);
}

TEST(DifferenceOfMeans, HasTheDegreesOfWelch) {
  // Equal scatter: those of both together. 2 and 2 samples with squared errors 1 and 1.
  const Estimate equal = difference_of_means({1.0, 3.0}, {0.0, 2.0});
  EXPECT_NEAR(equal.value, 1.0, 1e-12);
  EXPECT_NEAR(equal.standard_error, std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(equal.high - equal.value, 4.302653 * std::sqrt(2.0), 1e-5);  // two degrees
  // All scatter in one: its degrees alone.
  const Estimate one = difference_of_means({1.0, 3.0}, {5.0, 5.0, 5.0, 5.0});
  EXPECT_NEAR(one.high - one.value, 12.706205, 1e-5);  // one degree, an error of 1
  EXPECT_FALSE(std::isfinite(difference_of_means({1.0}, {5.0, 6.0}).high));
}

TEST(PairedSummaryText, SaysThreeNumbersAndHowTheyWerePaired) {
  PairedSummary s;
  s.reason = "the runs differ in seed";
  for (int k = 0; k < 5; ++k)
    s.numbers.push_back(unpaired_number("n" + std::to_string(k), "", {1.0, 0.1, 0.0, 0.0}, {1.0, 0.1, 0.0, 0.0}));
  const std::string text = paired_text(s);
  EXPECT_NE(text.find("n2"), std::string::npos);
  EXPECT_EQ(text.find("n3"), std::string::npos);
  EXPECT_NE(text.find("not paired, errors as of independent runs: the runs differ in seed"), std::string::npos);
  EXPECT_NE(text.find("not told from 0"), std::string::npos);
  EXPECT_EQ(table_of(s).rows.size(), 5U);
  EXPECT_EQ(table_of(s).rows.front().size(), table_of(s).header.size());
}

/// Grains of one size pack as they do here, by definition of beta; a wide distribution packs more densely.
TEST(CompressibleModel, BeginsAtGrainsOfOneSize) {
  const double gap = 0.9;
  const auto one = compressible_model(Grading::list({0.5}), gap);
  EXPECT_NEAR(one.poured, one.one_size, 1e-9);
  EXPECT_NEAR(one.vibrated_pressed, one.one_size, 1e-9);
  const auto wide = compressible_model(Grading::fuller(0.5, 1e-4, 1e-2), gap);
  EXPECT_GT(wide.poured, wide.one_size + 0.05);
  EXPECT_LT(wide.vibrated_pressed, 1.0);
}

std::string mix_text(const std::string& sand, const std::string& filler) {
  return R"(kind = "recipe"
[grains]
count = 900
[packing]
preparation = "fast"
[[constituent]]
name = "sand"
density = 2000
sizes = { form = "power-law", exponent = 3.5, radius_min = "1 mm", radius_max = "3 mm" }
)" + sand +
         R"(
[[constituent]]
name = "filler"
density = 4000
sizes = { form = "power-law", exponent = 3.5, radius_min = "0.4 mm", radius_max = "1 mm" }
)" + filler +
         "\n";
}

TEST(RecipeConstituents, MassesGiveTheSameSharesInAnyUnit) {
  const auto read = [](const std::string& sand, const std::string& filler) {
    return read_recipe_scene(Scene::parse(mix_text(sand, filler), "s"));
  };
  const RecipeScene shares = read("mass_share = 0.6", "mass_share = 0.4");
  const RecipeScene masses = read("mass = 900", "mass = 600");
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_NEAR(masses.constituents[k].volume_share, shares.constituents[k].volume_share, 1e-12);
  EXPECT_THROW((void)read("mass = 900", "mass_share = 0.4"), InputError);
  EXPECT_THROW((void)read("mass = 900\nmass_share = 0.6", "mass = 600"), InputError);
  EXPECT_THROW((void)read("mass = 0", "mass = 600"), InputError);
}

}  // namespace
}  // namespace softgrain
