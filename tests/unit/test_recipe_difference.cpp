// What a change of the mix does: shares that move, packings that are in both, paired and independent errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/core/error.h"
#include "common/core/few_samples.h"
#include "common/core/random.h"
#include "macrosim/body_contacts.h"
#include "pipelines/kinds/recipe/onset.h"
#include "pipelines/kinds/recipe/onset_pair.h"
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

TEST(ErrorParts, AddInSquaresWithTheDegreesOfEach) {
  const Estimate e = with_error_parts(2.0, {{3.0, 4.0}, {4.0, 8.0}});
  EXPECT_NEAR(e.standard_error, 5.0, 1e-12);
  const double degrees = 25.0 * 25.0 / (81.0 / 4.0 + 256.0 / 8.0);
  EXPECT_NEAR(e.high - 2.0, 5.0 * student95(degrees), 1e-9);
  EXPECT_EQ(with_error_parts(2.0, {{0.0, 4.0}}).high, 2.0);
  for (const std::vector<ErrorPart>& unknown : {std::vector<ErrorPart>{{3.0, 4.0}, {4.0, 0.0}},
                                                std::vector<ErrorPart>{}, std::vector<ErrorPart>{{kNaN, 0.0}}}) {
    EXPECT_TRUE(std::isinf(with_error_parts(2.0, unknown).standard_error));
    EXPECT_EQ(with_error_parts(2.0, unknown).value, 2.0);
  }
}

/// What is the same in both has no error, however few samples there are; beside another part it adds nothing.
TEST(ErrorParts, OfWhatIsTheSameInBothAreExactlyZero) {
  const Estimate exact = with_error_parts(0.0, {kExactPart, kExactPart});
  EXPECT_EQ(exact.standard_error, 0.0);
  EXPECT_EQ(exact.low, 0.0);
  EXPECT_EQ(exact.high, 0.0);
  const Estimate beside = with_error_parts(2.0, {kExactPart, {3.0, 4.0}});
  EXPECT_EQ(beside.high, with_error_parts(2.0, {{3.0, 4.0}}).high);
  // One sample of each: nothing tells its error, though its scatter is 0.
  EXPECT_TRUE(std::isinf(with_error_parts(2.0, {{0.0, 0.0}}).standard_error));
}

TEST(PairedSummaryText, SaysThatADifferenceIsExact) {
  PairedSummary s;
  PairedNumber n = unpaired_number("K0", "", {0.5, 0.1, 0.0, 0.0}, {0.5, 0.1, 0.0, 0.0});
  n.error = n.low = n.high = 0.0;
  n.pairs = 1;
  s.paired = true;
  s.numbers = {n};
  EXPECT_NE(paired_text(s).find("difference 0 +- 0 (exact: "), std::string::npos) << paired_text(s);
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

TEST(PairedSummaryText, GivesStressesWithTheirUnit) {
  PairedSummary s;
  s.numbers.push_back(unpaired_number("modulus", "Pa", {3e7, 2e6, 0.0, 0.0}, {3.05e7, 2e6, 0.0, 0.0}));
  const std::string text = paired_text(s);
  EXPECT_NE(text.find("modulus: 30 MPa - 30.5 MPa: difference -500 kPa +- 2.8 MPa"), std::string::npos) << text;
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

/// A sample under oedometric load that follows the equation of state with K = 0.05 and n = 1.6 from its onset.
MacroCurve sample_from(double onset, double modulus, std::int64_t sample) {
  MacroCurve c;
  c.sample = sample;
  c.start.youngs_modulus = modulus;
  c.stages = {{"load", StageKind::oedometric, StageKind::oedometric, {}}};
  std::vector<double>& phi = c.more[kSolidFraction];
  for (int k = 0; k < 6; ++k) {
    const double p = 1e-4 * std::pow(10.0, 0.3 * k);
    phi.push_back(state_phi(StateForm::porosity, 0.05, 1.6, onset, p));
    c.strain.push_back(1.0 - phi.front() / phi.back());
    c.stress_axial.push_back(p * modulus * 3.0 / 2.1);
    for (auto* lateral : {&c.stress_lateral, &c.stress_x, &c.stress_y})
      lateral->push_back(0.55 * c.stress_axial.back());
    c.stage.push_back(0.0);
  }
  return c;
}

constexpr double kScatter = 0.003;

/// A run whose packings lie on rods but for the scatter of their samples; `seed`: of the scatter.
MixRun synthetic_run(const std::string& share, const std::string& rest, std::uint64_t seed, int samples = 3) {
  MixRun run{read_recipe_scene(Scene::parse(mix_text("mass_share = " + share, "mass_share = " + rest) +
                                                "[check]\ngrains = 0\n[law]\nreplicates = 200\n",
                                            "s")),
             {},
             {}};
  RandomStream random(seed, RandomPurpose::test, 12);
  for (const MaterialVariant& v : run.scene.material.variants) {
    VariantResult r{&v, "", {}, nullptr};
    const double onset = RodCurve(*v.setup.spec.solid_sizes).at(1.0);
    for (int s = 0; s < samples; ++s)
      r.curves.push_back(sample_from(onset + kScatter * random.normal(), v.setup.spec.youngs_modulus, s));
    run.results.push_back(std::move(r));
  }
  return run;
}

/// Error of the difference of the onsets of two runs, and whether its interval holds that of rods.
struct OnsetDifference {
  Estimate estimate;
  double truth;
};
OnsetDifference onset_difference(const MixRun& a, const MixRun& b) {
  const PairedOnsets onsets(a, b);
  const OnsetPair whole = onsets.joined(0, a.scene.levels.size());
  const double value = onsets.value(whole, true, onset_itself) - onsets.value(whole, false, onset_itself);
  const auto truth = [](const MixRun& run) {
    return RodCurve(joined(run.scene.levels, 0, run.scene.levels.size())).at(1.0);
  };
  return {onsets.difference(value, whole, onset_itself, onset_itself, {}), truth(a) - truth(b)};
}

/// Two mixes that share no packing, hence scatter independently: a small slope of the residuals took all error away.
TEST(RecipeDifference, IndependentPackingsKeepTheirScatter) {
  double least = kInfinity;
  int held = 0;
  constexpr int kTrials = 10;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    const OnsetDifference d =
        onset_difference(synthetic_run("0.6", "0.4", 2 * trial + 1), synthetic_run("0.65", "0.35", 2 * trial + 2));
    least = std::min(least, d.estimate.standard_error);
    held += d.estimate.low <= d.truth && d.truth <= d.estimate.high ? 1 : 0;
  }
  // The onset of the whole is a mean over some packings of three samples each.
  EXPECT_GT(least, 0.3 * kScatter);
  EXPECT_GE(held, kTrials - 1);
}

TEST(RecipeDifference, PackingsOfBothCancel) {
  const MixRun a = synthetic_run("0.6", "0.4", 1);
  const OnsetDifference other = onset_difference(a, synthetic_run("0.65", "0.35", 2));
  MixRun b = synthetic_run("0.65", "0.35", 2);
  for (std::size_t v = 0; v < b.results.size(); ++v) b.results[v].curves = a.results[v].curves;
  const PairedOnsets same(a, b);
  EXPECT_EQ(same.same(), same.packings());
  EXPECT_LT(onset_difference(a, b).estimate.standard_error, 0.5 * other.estimate.standard_error);
  const OnsetDifference none = onset_difference(a, a);
  EXPECT_EQ(none.estimate.value, 0.0);
  EXPECT_EQ(none.estimate.standard_error, 0.0);
}

/// A number that a few replicates do not have keeps its error; without many of them there is none, and it says so.
TEST(RecipeDifference, NumbersThatManyReplicatesDoNotHaveHaveNoError) {
  const MixRun a = synthetic_run("0.6", "0.4", 1);
  const MixRun b = synthetic_run("0.65", "0.35", 2);
  const PairedOnsets onsets(a, b);
  const OnsetPair whole = onsets.joined(0, a.scene.levels.size());
  std::vector<double> drawn;
  for (const std::vector<double>& way : whole.a.replicates) drawn.insert(drawn.end(), way.begin(), way.end());
  std::ranges::sort(drawn);
  const auto up_to = [&](double share) -> NumberOf {
    const double most = drawn[static_cast<std::size_t>(share * static_cast<double>(drawn.size() - 1))];
    return [most, values = whole.a.value](double onset, double, double) {
      return onset <= most || std::ranges::find(values, onset) != values.end() ? onset : kNaN;
    };
  };
  EXPECT_EQ(onsets.undefined_share(whole, onset_itself, onset_itself), 0.0);
  EXPECT_LT(onsets.undefined_share(whole, up_to(0.98), onset_itself), kMostUndefined);
  EXPECT_TRUE(std::isfinite(onsets.difference(0.1, whole, up_to(0.98), onset_itself, {}).standard_error));
  EXPECT_GT(onsets.undefined_share(whole, up_to(0.7), onset_itself), kMostUndefined);
  EXPECT_TRUE(std::isinf(onsets.difference(0.1, whole, up_to(0.7), onset_itself, {}).standard_error));
  PairedNumber n = unpaired_number("x", "", {1.0, 0.1, 0.0, 0.0}, {1.0, 0.1, 0.0, 0.0});
  n.error = kInfinity;
  n.unknown = "30 % of the replicates do not go through these stresses";
  PairedSummary s;
  s.numbers.push_back(n);
  EXPECT_NE(paired_text(s).find("(no error: 30 % of the replicates"), std::string::npos) << paired_text(s);
}

/// Checks that miss their predictions by as much on the same side say nothing of the difference.
TEST(RecipeDifference, ChecksThatMissAlikeCancel) {
  const auto missed = [](const std::string& share, const std::string& rest, double by) {
    MixRun run = synthetic_run(share, rest, 1);
    run.summary.recipe.check.emplace();
    run.summary.recipe.check->measured.value = 0.6 + by;
    run.summary.recipe.check->predicted.onset = {0.6, 0.0, 0.6, 0.6};
    run.summary.recipe.check->outside = std::abs(by);
    return run;
  };
  const auto widened = [](const MixRun& a, const MixRun& b) {
    return PairedOnsets(a, b).joined(0, a.scene.levels.size()).widen;
  };
  const MixRun above = missed("0.6", "0.4", 0.004);
  EXPECT_NEAR(widened(above, missed("0.65", "0.35", 0.004)), 0.0, 1e-15);
  EXPECT_NEAR(widened(above, missed("0.65", "0.35", 0.001)), 0.003, 1e-12);
  EXPECT_NEAR(widened(above, missed("0.65", "0.35", -0.001)), 0.005, 1e-12) << "one above, one below";
}

TEST(RecipeDifference, OfSinglePackingsHasNoError) {
  const OnsetDifference d = onset_difference(synthetic_run("0.6", "0.4", 1, 1), synthetic_run("0.65", "0.35", 2, 1));
  EXPECT_TRUE(std::isinf(d.estimate.standard_error));
  EXPECT_TRUE(std::isfinite(d.estimate.value));
}

}  // namespace
}  // namespace softgrain
