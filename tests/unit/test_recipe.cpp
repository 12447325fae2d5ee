// Scenes of kind "recipe": where the curve is cut, what is packed, how levels are put together, what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calibrate/rod_packing.h"
#include "calibrate/state_curves.h"
#include "common/core/error.h"
#include "pipelines/kinds/material/run.h"
#include "pipelines/kinds/recipe/law.h"
#include "pipelines/kinds/recipe/onset.h"
#include "pipelines/kinds/recipe/scene.h"

namespace softgrain {
namespace {

double total(const std::vector<RecipeLevel>& levels) {
  double sum = 0.0;
  for (const RecipeLevel& level : levels) sum += level.share;
  return sum;
}

TEST(RecipeLevels, FollowEachOtherAndHoldAllOfTheVolume) {
  const auto whole = Grading::fuller(0.23, 5e-8, 5e-4);
  const auto levels = levels_of(whole, find_cuts(whole, 3.2, 0.005));
  ASSERT_EQ(levels.size(), 8U);
  EXPECT_NEAR(total(levels), 1.0, 1e-12);
  double above = 0.0;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    EXPECT_NEAR(levels[k].high / levels[k].low, std::sqrt(10.0), 1e-9) << k;
    if (k > 0) {
      EXPECT_NEAR(levels[k].high, levels[k - 1].low, 1e-12 * levels[k].high) << k;
    }
    above += levels[k].share;
    EXPECT_NEAR(above, 1.0 - whole.passing(levels[k].low), 1e-9) << k;
  }
}

TEST(RecipeLevels, WithNextToNothingGoToTheirNeighbour) {
  // Of three slices of equal ratio the middle one holds 0.1 % and the last 0.2 %.
  const auto whole = Grading::classes({{0.1, 1.0, 4.0, 0.997}, {0.01, 0.1, 4.0, 0.001}, {0.001, 0.01, 4.0, 0.002}});
  const auto levels = levels_of(whole, find_cuts(whole, 10.0, 0.005));
  ASSERT_EQ(levels.size(), 1U);
  EXPECT_NEAR(levels[0].share, 1.0, 1e-12);
  EXPECT_NEAR(levels[0].low, 0.001, 1e-12);
}

TEST(RecipeLevels, OfOneShapeAreOnePackingWhereverTheyAre) {
  const auto whole = Grading::power_law(3.77, 1e-6, 1e-3);
  const auto levels = levels_of(whole, find_cuts(whole, 3.2, 0.005));
  ASSERT_EQ(levels.size(), 6U);
  for (std::size_t k = 1; k < levels.size(); ++k) EXPECT_EQ(slice_of(levels[k]), slice_of(levels[0])) << k;
  EXPECT_EQ(pair_of(levels[0], levels[1], 0.4), pair_of(levels[3], levels[4], 0.4));
  EXPECT_NEAR(pair_of(levels[0], levels[1], 0.4).passing(0.01 * cut_of_pair(levels[0], levels[1])), 0.4, 1e-9);
  const Grading three = joined(levels, 0, 3);
  EXPECT_NEAR(three.largest(), 0.01, 1e-12);
  EXPECT_NEAR(three.passing(0.01 * std::pow(10.0, -0.5)),
              (levels[1].share + levels[2].share) / (levels[0].share + levels[1].share + levels[2].share), 1e-9);
}

TEST(RecipeLevels, CountGrainsByTheirMeanVolume) {
  const double volume = mean_grain_volume({{1.0, 1.0, 4.0, 0.5}, {2.0, 2.0, 4.0, 0.5}});
  // Eight small grains for a large one of equal volume: nine grains of 16 units of 4/3 pi.
  EXPECT_NEAR(volume, 16.0 / 9.0 * 4.18879020478639, 1e-9);
}

RecipeScene read_recipe(const std::string& more, const std::string& grains = "count = 600\nratio = 6") {
  return read_recipe_scene(
      Scene::parse("kind = \"recipe\"\n[grains]\n" + grains + "\n[packing]\npreparation = \"fast\"\n" + more, "s"));
}

std::string refusal(const std::string& more, const std::string& grains = "count = 600\nratio = 6") {
  try {
    (void)read_recipe(more, grains);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(RecipeScene, PacksNothingTwice) {
  const RecipeScene scene =
      read_recipe("[levels]\nratio = 2\n[check]\ngrains = 0\n", "count = 900\nratio = 8\nexponent = 3.7");
  ASSERT_EQ(scene.levels.size(), 3U);
  EXPECT_EQ(scene.slice, (std::vector<std::size_t>{0, 0, 0}));
  ASSERT_EQ(scene.mixed.size(), 2U);
  EXPECT_EQ(scene.mixed[0], scene.mixed[1]);
  EXPECT_EQ(scene.material.variants.size(), 2U + scene.mixtures.size());
  EXPECT_TRUE(scene.material.variants[kSheared].same_packings);
  EXPECT_FALSE(scene.checked);
}

/// Progress counts packings: a second test of one has the number of its packing.
TEST(RecipeScene, PackingsAreCountedInProgress) {
  const RecipeScene scene =
      read_recipe("[levels]\nratio = 2\n[check]\ngrains = 0\n", "count = 900\nratio = 8\nexponent = 3.7");
  const std::vector<MaterialVariant>& all = scene.material.variants;
  const std::string of = " of " + std::to_string(all.size() - 1) + ", ";
  EXPECT_EQ(packing_title(all, all.front()), "packing 1" + of + all.front().name);
  EXPECT_EQ(packing_title(all, all[kSheared]), "packing 1" + of + all[kSheared].name);
  EXPECT_EQ(packing_title(all, all.back()), "packing " + std::to_string(all.size() - 1) + of + all.back().name);
  const std::vector<MaterialVariant> alone{all.front()};
  EXPECT_EQ(packing_title(alone, alone.front()), alone.front().name);
}

TEST(RecipeLaw, WhatIsMissingWithoutACellLawIsSaidWithWhatToDo) {
  const std::string staged = no_cell_law_text({"shear memory: flat", "excess pores: few"}, true, false);
  for (const char* part : {"no cell law", "shear memory: flat; excess pores: few", "cell_law.toml",
                           "curve \"cell law\"", "the stages do not need them", "more grains"})
    EXPECT_NE(staged.find(part), std::string::npos) << part << " not in " << staged;
  const std::string shells = no_cell_law_text({"few"}, false, true);
  EXPECT_NE(shells.find("curves \"cell law\" and \"shell law\""), std::string::npos) << shells;
  EXPECT_NE(shells.find("equation of state alone"), std::string::npos) << shells;
}

TEST(RecipeScene, TakesConstituentsByVolume) {
  const RecipeScene scene = read_recipe(R"(
[[constituent]]
name = "sand"
mass_share = 0.6
density = 2000
sizes = { form = "power-law", exponent = 3.5, radius_min = "1 mm", radius_max = "3 mm" }
[[constituent]]
name = "filler"
mass_share = 0.4
density = 4000
sizes = { form = "power-law", exponent = 3.5, radius_min = "0.4 mm", radius_max = "1 mm" }
)",
                                        "count = 900");
  ASSERT_EQ(scene.constituents.size(), 2U);
  EXPECT_NEAR(scene.constituents[0].volume_share, 0.75, 1e-12);
  EXPECT_NEAR(scene.sizes.passing(1e-3), 0.25, 1e-9);
  EXPECT_NEAR(fines_over_coarse(scene, 0),
              scene.sizes.passing(scene.levels[0].low) / (1.0 - scene.sizes.passing(scene.levels[0].low)), 1e-9);
}

/// Results in which packing v has a lateral stress of 0.4 + 0.01 v times the axial one.
std::vector<VariantResult> results_by_ratio(const RecipeScene& scene) {
  std::vector<VariantResult> out;
  for (const MaterialVariant& v : scene.material.variants) {
    MacroCurve c;
    c.stress_axial = {1.0, 3.0, 2.0};
    c.stress_lateral = {0.9, 0.9, (0.8 + 0.02 * static_cast<double>(out.size()))};
    out.push_back({&v, "", {c}, nullptr});
  }
  return out;
}

/// The check is what the prediction of K0 is held against: it takes no part in it.
TEST(RecipeLaw, PredictsTheLateralStressWithoutTheCheck) {
  const RecipeScene scene = read_recipe("[levels]\nratio = 2\nmixtures = [0.2, 0.5, 0.8]\n[check]\ngrains = 4000\n",
                                        "count = 900\nratio = 6");
  ASSERT_TRUE(scene.checked);
  std::vector<VariantResult> results = results_by_ratio(scene);
  const std::size_t chosen = lateral_packing(scene, scene.levels.size());
  EXPECT_NE(chosen, *scene.checked);
  const Estimate before = predicted_lateral_ratio(scene, results, scene.levels.size());
  EXPECT_NEAR(before.value, 0.4 + 0.01 * static_cast<double>(chosen), 1e-12);
  EXPECT_GT(before.standard_error, 0.0);
  results[*scene.checked].curves.front().stress_lateral.back() = 2.0;
  const Estimate after = predicted_lateral_ratio(scene, results, scene.levels.size());
  EXPECT_EQ(after.value, before.value);
  EXPECT_EQ(after.standard_error, before.standard_error);
  EXPECT_NEAR(end_ratios(results[*scene.checked]).front(), 1.0, 1e-12);
  // With stages: where the axial stress is highest.
  results[chosen].curves.front().test = MacroTest::stages;
  EXPECT_NEAR(end_ratios(results[chosen]).front(), 0.3, 1e-12);
}

TEST(RecipeScene, SaysAllThatIsWrongWithConstituentsAtOnce) {
  const std::string text = refusal(R"(
[[constituent]]
name = "sand"
mass_share = 0.6
mu_r = 0.1
sizes = { form = "power-law", exponent = 3.5, radius_min = "3 mm", radius_max = "1 mm" }
[[constituent]]
name = "sand"
mass_share = 0.3
densty = 4000
sizes = { form = "power-law", exponent = 3.5, radius_min = "0.3 mm", radius_max = "1 mm" }
)",
                                   "count = 900\nratio = 3");
  for (const char* part :
       {"goes into [material]: all grains have one resistance to rolling", "must be above radius_min", "is used twice",
        "nearest known key is 'density'", "goes without [[constituent]]"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

TEST(RecipeScene, RefusesWhatCannotAct) {
  const std::string densities = R"(
[material]
density = 2500
[[constituent]]
name = "sand"
mass_share = 0.6
density = 2000
sizes = { form = "power-law", exponent = 3.5, radius_min = "1 mm", radius_max = "3 mm" }
[[constituent]]
name = "filler"
mass_share = 0.4
density = 4000
sizes = { form = "power-law", exponent = 3.5, radius_min = "0.4 mm", radius_max = "1 mm" }
)";
  EXPECT_NE(refusal(densities, "count = 900").find("every [[constituent]] gives its own"), std::string::npos);
  EXPECT_NE(refusal("[levels]\ncut_diameters = []\n").find("at least one is needed"), std::string::npos);
}

/// --set check.grains=0 alone switches the check of a scene off.
TEST(RecipeScene, OneNumberSwitchesTheCheckOff) {
  const RecipeScene with =
      read_recipe("[levels]\nratio = 2\n[check]\ngrains = 20000\nsamples = 2\n", "count = 900\nratio = 8");
  const RecipeScene without =
      read_recipe("[levels]\nratio = 2\n[check]\ngrains = 0\nsamples = 2\n", "count = 900\nratio = 8");
  EXPECT_TRUE(with.checked.has_value());
  EXPECT_FALSE(without.checked.has_value());
  EXPECT_EQ(without.material.variants.size() + 1, with.material.variants.size());
}

TEST(RecipeScene, RefusesSharesThatDoNotAddUp) {
  const std::string text = refusal(R"(
[[constituent]]
name = "sand"
mass_share = 0.6
sizes = { form = "power-law", exponent = 3.5, radius_min = "1 mm", radius_max = "3 mm" }
[[constituent]]
name = "filler"
mass_share = 0.3
sizes = { form = "power-law", exponent = 3.5, radius_min = "0.3 mm", radius_max = "1 mm" }
)",
                                   "count = 900");
  EXPECT_NE(text.find("the mass shares add up to 0.9; they must add up to 1"), std::string::npos) << text;
}

/// Nearly all of the volume would be cement; the message was one on levels that are too far apart.
TEST(RecipeScene, RefusesADensityInAnotherUnitThanTheOthers) {
  const std::string text = refusal(R"(
[[constituent]]
name = "sand"
mass_share = 0.6
density = 2650
sizes = { form = "power-law", exponent = 3.5, radius_min = "1 mm", radius_max = "3 mm" }
[[constituent]]
name = "cement"
mass_share = 0.4
density = 3.15
sizes = { form = "power-law", exponent = 3.5, radius_min = "0.3 mm", radius_max = "1 mm" }
)",
                                   "count = 900");
  EXPECT_NE(text.find("another constituent has 2650 kg/m^3: is a unit missing, such as density = \"3.15 g/cm^3\"?"),
            std::string::npos)
      << text;
}

TEST(RecipeScene, RefusesLevelsThatNoPackingHolds) {
  EXPECT_NE(refusal("", "count = 600\nratio = 2").find("the sizes make one level"), std::string::npos);
  EXPECT_NE(refusal("", "count = 100\nratio = 60").find("are too far apart for a packing of 100 grains"),
            std::string::npos);
  EXPECT_NE(refusal("[levels]\ncut_diameters = [\"40 mm\"]\n").find("cuts off no level"), std::string::npos);
  EXPECT_NE(refusal("[levels]\ncut_diameters = [\"5.34 mm\", \"12 mm\"]\n").find("of the volume; 0.5 % at least"),
            std::string::npos);
  EXPECT_NE(refusal("[macro]\ngrains = 40\n", "count = 2000\nratio = 9").find("the coarsest level under load"),
            std::string::npos);
  EXPECT_NE(refusal("[levels]\nmixtures = [0.2, 0.1, 0.4]\n").find("shares must ascend"), std::string::npos);
}

/// A fit whose onsets are these, by variant; replicates all alike.
StateFit fit_of(const RecipeScene& scene, const std::vector<double>& onsets) {
  StateFit fit;
  fit.usable = true;
  fit.degrees = 12;
  std::vector<double> replicate{0.0, 2.0};
  for (std::size_t v = 0; v < scene.material.variants.size(); ++v) {
    if (scene.material.variants[v].same_packings) continue;
    StateGroup group;
    group.name = scene.material.variants[v].name;
    group.onset = {onsets[v], 0.001, onsets[v], onsets[v]};
    fit.groups.push_back(group);
    replicate.push_back(onsets[v]);
  }
  fit.replicates.assign(40, replicate);
  return fit;
}

RecipeScene three_levels() {
  return read_recipe("[levels]\nratio = 2\nmixtures = [0.25, 0.5, 0.75]\n[check]\ngrains = 0\n",
                     "count = 900\nratio = 8\nexponent = 3.7");
}

TEST(LevelForms, RodsFindTheGapThatOnsetsWereMadeWith) {
  const RecipeScene scene = three_levels();
  constexpr double kGap = 1.1;
  std::vector<double> onsets;
  for (const MaterialVariant& v : scene.material.variants)
    onsets.push_back(RodCurve(*v.setup.spec.solid_sizes).at(kGap));
  const LevelForms forms(scene, fit_of(scene, onsets));
  EXPECT_NEAR(forms.gap(), kGap, 1e-4);
  EXPECT_LT(forms.rods_deviation(), 1e-6);
  const OnsetByForms whole = forms.joined_onset(0, 3);
  EXPECT_NEAR(whole.rods, RodCurve(joined(scene.levels, 0, 3), 20000).at(kGap), 1e-6);
  EXPECT_LE(whole.onset.low, std::min(whole.rods, whole.levels) + 1e-12);
  EXPECT_GE(whole.onset.high, std::max(whole.rods, whole.levels) - 1e-12);
  EXPECT_NEAR(forms.joined_onset(0, 3, 0.02).onset.low, whole.onset.low - 0.02, 1e-12);
}

TEST(LevelForms, LeanToTheFormThatTheCheckIsNearer) {
  const RecipeScene scene = three_levels();
  std::vector<double> onsets;
  for (const MaterialVariant& v : scene.material.variants)
    onsets.push_back(RodCurve(*v.setup.spec.solid_sizes).at(1.1));
  onsets[scene.mixed[0][2]] -= 0.02;  // levels fall below the rods
  const auto value_for = [&](double share, double error) {
    LevelForms forms(scene, fit_of(scene, onsets));
    const OnsetByForms before = forms.joined_onset(0, 3);
    EXPECT_NEAR(before.onset.value, 0.5 * (before.levels + before.rods), 1e-12);
    EXPECT_GT(before.rods - before.levels, 0.01);
    forms.lean(3, before.levels + share * (before.rods - before.levels), error);
    EXPECT_NEAR(forms.joined_onset(0, 3).onset.value,
                before.levels + forms.share_of_rods() * (before.rods - before.levels), 1e-12);
    return forms.share_of_rods();
  };
  EXPECT_NEAR(value_for(0.5, 0.001), 0.5, 1e-12);
  EXPECT_GT(value_for(1.0, 0.001), 0.55);
  EXPECT_LT(value_for(0.0, 0.001), 0.45);
  EXPECT_GT(value_for(1.0, 0.001), value_for(1.0, 0.02));  // less is learned from what is known less
  EXPECT_EQ(value_for(9.0, 0.001), 1.0);
}

/// By hand: w of the mixtures is 0.6 at every share, so that e = e_f (0.6 + r)/(1 + r) level by level.
TEST(LevelForms, PoresOfLevelsGoWithThoseOfTheirFines) {
  const RecipeScene scene = three_levels();
  constexpr double kAlone = 0.7;  // void ratio of every level
  constexpr double kBeside = 0.6;
  std::vector<double> onsets(scene.material.variants.size(), 1.0 / (1.0 + kAlone));
  for (std::size_t m = 0; m < scene.mixtures.size(); ++m) {
    const double r = scene.mixtures[m] / (1.0 - scene.mixtures[m]);
    onsets[scene.mixed[0][m]] = 1.0 / (1.0 + kAlone * (kBeside + r) / (1.0 + r));
  }
  const LevelForms forms(scene, fit_of(scene, onsets));
  double e = kAlone;
  double volume = scene.levels[2].share;
  for (std::size_t k = 2; k-- > 0;) {
    const double r = volume / scene.levels[k].share;
    ASSERT_GT(r / (1.0 + r), scene.mixtures.front());  // below, w rises to that of the level alone
    e *= (kBeside + r) / (1.0 + r);
    volume += scene.levels[k].share;
    EXPECT_NEAR(forms.joined_onset(k, 3 - k).levels, 1.0 / (1.0 + e), 1e-12) << k;
  }
  EXPECT_NEAR(forms.own_onset(1), 1.0 / (1.0 + kAlone), 1e-12);
}

TEST(RecipeLaw, FollowsTheEquationOfStateFromTheStartPressure) {
  WholeLaw law;
  law.modulus = {0.05, 0.0, 0.05, 0.05};
  law.exponent = {2.0, 0.0, 2.0, 2.0};
  law.onset = {0.8, 0.005, 0.79, 0.81};
  law.shape = {{0.0, 0.02}, {1.0, 0.8}, {0.0, 0.04}, {1.0, 0.5}, {0.0, 0.02}};
  law.start_pressure = 1e-4;
  const Estimate start = solid_fraction_of(law);
  EXPECT_NEAR(start.value, 0.8 + 0.2 * std::sqrt(1e-4 / 0.05), 1e-12);
  const RecipeCurve c = curve_of(law, 0.04, 8);
  ASSERT_EQ(c.strain.size(), 9U);
  EXPECT_NEAR(c.axial.front(), 1e-4, 1e-12);                             // at rest, alike on all sides
  const double early = (start.value / (1.0 - c.strain[2]) - 0.8) / 0.2;  // at 0.01: factor 0.9, ratio 0.75
  EXPECT_NEAR(c.axial[2], 3.0 * 0.9 * 0.05 * early * early / 2.5, 1e-9);
  const double phi = start.value / (1.0 - c.strain[8]);
  const double p = 0.05 * std::pow((phi - 0.8) / 0.2, 2);
  EXPECT_NEAR(c.axial.back(), 3.0 * 0.8 * p / 2.0, 1e-9);
  EXPECT_NEAR(c.lateral.back(), 0.5 * c.axial.back(), 1e-12);
  for (std::size_t k = 1; k < c.strain.size(); ++k) {
    EXPECT_LT(c.low[k], c.axial[k]);
    EXPECT_GT(c.high[k], c.axial[k]);
  }
  // Beyond the pressures of the fit nothing says how far off the law is.
  law.pressure_high = (c.axial[4] + 2.0 * c.lateral[4]) / 3.0;
  const RecipeCurve far = curve_of(law, 0.04, 8);
  EXPECT_EQ(far.axial, c.axial);
  EXPECT_EQ(far.low[4], c.low[4]);
  EXPECT_TRUE(std::isnan(far.low.back()) && std::isnan(far.high.back()));
  // And where samples tell no error of the onset there is no band at all.
  law.onset = {0.8, HUGE_VAL, -HUGE_VAL, HUGE_VAL};
  const RecipeCurve bare = curve_of(law, 0.04, 8);
  EXPECT_EQ(bare.axial, c.axial);
  EXPECT_TRUE(bare.low.empty() && bare.high.empty());
  EXPECT_TRUE(std::isinf(solid_fraction_of(law).high));
}

/// At rest sides may bear a little more than the axis: the band holds the value there too.
TEST(RecipeLaw, BandsHoldTheirValue) {
  WholeLaw law;
  law.modulus = {0.05, 0.0, 0.05, 0.05};
  law.exponent = {2.0, 0.0, 2.0, 2.0};
  law.onset = {0.8, 0.005, 0.79, 0.81};
  law.shape = {{0.0, 0.02}, {1.0, 0.8}, {0.001, 0.04}, {1.01, 0.5}, {0.002, 0.02}};
  law.start_pressure = 1e-4;
  const RecipeCurve c = curve_of(law, 0.04, 8);
  for (std::size_t k = 0; k < c.strain.size(); ++k) {
    EXPECT_LE(c.low[k], c.axial[k]) << k;
    EXPECT_GE(c.high[k], c.axial[k]) << k;
  }
}

/// Replicates that all lie to one side of the estimate.
TEST(LevelForms, IntervalsHoldTheirValue) {
  const RecipeScene scene = three_levels();
  std::vector<double> onsets;
  for (const MaterialVariant& v : scene.material.variants)
    onsets.push_back(RodCurve(*v.setup.spec.solid_sizes).at(1.1));
  for (const double aside : {-0.02, 0.02}) {
    StateFit fit = fit_of(scene, onsets);
    for (auto& replicate : fit.replicates)
      for (std::size_t k = 2; k < replicate.size(); ++k) replicate[k] += aside;
    const OnsetByForms whole = LevelForms(scene, fit).joined_onset(0, 3);
    EXPECT_LE(whole.onset.low, whole.onset.value) << aside;
    EXPECT_GE(whole.onset.high, whole.onset.value) << aside;
  }
}

TEST(RecipeLaw, ModuliAreSecantsBetweenTheSameStresses) {
  RecipeCurve linear{"material law", {0.0, 0.01, 0.02}, {}, {}, {}, {}, ""};
  RecipeCurve low = linear;
  low.name = "never there";
  for (const double e : linear.strain) {
    const double s = 2.0 * -std::log1p(-e);
    linear.axial.push_back(s);
    linear.low.push_back(0.9 * s);
    linear.high.push_back(1.2 * s);
    low.axial.push_back(0.1 * s);
  }
  std::vector<RecipeCurve> curves{linear, low};
  set_moduli(curves, {0.01, 0.03});
  ASSERT_TRUE(curves[0].modulus);
  EXPECT_NEAR(curves[0].modulus->value, 2.0, 0.01);
  EXPECT_NEAR(curves[0].modulus->low, 1.8, 0.01);
  EXPECT_NEAR(curves[0].modulus->high, 2.4, 0.01);
  EXPECT_FALSE(curves[1].modulus);
  set_moduli(curves, {0.0, 0.0});  // the upper half of what the lower end of its band comes to
  EXPECT_NEAR(curves[0].modulus->from, 0.5 * linear.low.back(), 1e-15);
  EXPECT_NEAR(curves[0].modulus->low, 1.8, 0.01);
}

/// Few grains are coarse in a mixture of 2000 with four fifths of fines: their images would meet when it is pressed.
TEST(RecipeScene, RaisesDefaultCountsThatHaveNoRoomAndRefusesGivenOnes) {
  const std::string sizes = "exponent = 3.5\nratio = 10";
  const std::string levels = "[levels]\nratio = 3.2\n[check]\ngrains = 0\n[macro]\ngrains = 300\n";
  const RecipeScene scene = read_recipe(levels, sizes);
  ASSERT_FALSE(scene.raised.empty());
  EXPECT_NE(scene.raised[0].find("in place of the default 2000 ([grains] count)"), std::string::npos)
      << scene.raised[0];
  std::size_t larger = 0;
  for (const MaterialVariant& v : scene.material.variants) {
    EXPECT_GE(v.setup.spec.bodies, 2000) << v.name;
    larger += v.setup.spec.bodies > 2000 ? 1 : 0;
  }
  EXPECT_EQ(larger, scene.raised.size());
  // A number that was asked for is kept as long as its grains can be placed.
  const RecipeScene given = read_recipe(levels, sizes + "\ncount = 2000");
  EXPECT_TRUE(given.raised.empty());
  EXPECT_EQ(given.doubts.size(), scene.raised.size());
  const std::string none = refusal(levels, sizes + "\ncount = 1100");
  for (const char* part : {"count", "packing levels-1-2", "1100 grains are too few for a periodic cell",
                           "or more have room ([grains] count)", " are enough to place every packing; levels closer",
                           " radii of the largest"})
    EXPECT_NE(none.find(part), std::string::npos) << part << "\n" << none;
  // Grains that the first refusal asks for, in all packings, are not refused again.
  const std::size_t end = none.find(" are enough to place every packing");
  const std::size_t begin = none.rfind(' ', end - 1) + 1;
  EXPECT_NO_THROW((void)read_recipe(levels, sizes + "\ncount = " + none.substr(begin, end - begin))) << none;
  for (const char* part : {"boundary", "macro:"}) EXPECT_EQ(none.find(part), std::string::npos) << none;
}

}  // namespace
}  // namespace softgrain
