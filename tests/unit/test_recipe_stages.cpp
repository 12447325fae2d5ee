// Recipes under stages of given stresses: what is read and refused, closed forms of moduli, indices and K0.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calibrate/state_curves.h"
#include "common/core/error.h"
#include "macrosim/body_contacts.h"
#include "macrosim/preparation.h"
#include "macrosim/test_protocol.h"
#include "pipelines/compare/stage_results.h"
#include "pipelines/kinds/recipe/stages.h"

namespace softgrain {
namespace {

constexpr const char* kLoad = "[[stage]]\nkind = \"oedometric\"\nstress = \"1 MPa\"\n";

RecipeScene read_staged(const std::string& stages, const std::string& packing = "start_pressure = \"50 kPa\"\n",
                        const std::string& more = "") {
  return read_recipe_scene(
      Scene::parse("kind = \"recipe\"\n[material]\nE = \"70 GPa\"\n[grains]\ncount = 900\nratio = "
                   "6\n[levels]\nratio = 2.5\n[check]\ngrains = 0\n[packing]\npreparation = "
                   "\"rodded\"\n" +
                       packing + more + stages,
                   "s"));
}

std::string stage_refusal(const std::string& stages, const std::string& packing = "start_pressure = \"50 kPa\"\n",
                          const std::string& more = "") {
  try {
    (void)read_staged(stages, packing, more);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

void expect_part(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

TEST(RecipeStageScene, AllPackingsGoThroughTheStagesAndTheFinesAreShearedAtTheirStress) {
  const std::string unload = "[[stage]]\nkind = \"unload\"\nstress = \"0.2 MPa\"\n[[stage]]\nkind = \"reload\"\n";
  const RecipeScene scene = read_staged(std::string(kLoad) + unload);
  const double start = 50e3 / 70e9;
  for (const MaterialVariant& v : scene.material.variants) {
    const MacroSpec& spec = v.setup.spec;
    EXPECT_DOUBLE_EQ(spec.start_pressure, start) << v.name;
    EXPECT_EQ(spec.preparation, Preparation::rodded);
    EXPECT_EQ(spec.protocol.friction, kRoddedFriction);
    ASSERT_EQ(spec.test, MacroTest::stages) << v.name;
    if (v.same_packings) continue;
    ASSERT_EQ(spec.stages.size(), 3U) << v.name;
    EXPECT_EQ(*spec.stages[0].target_stress(), 1e6);
    EXPECT_EQ(*spec.stages[1].target_stress(), 2e5);
    EXPECT_EQ(highest_stress(spec), 1e6);
    EXPECT_EQ(stages_text(spec), "from 50 kPa, oedometric to 1 MPa, unload to 200 kPa, reload to 1 MPa");
  }
  const MacroSpec& sheared = scene.material.variants[kSheared].setup.spec;
  ASSERT_EQ(sheared.stages.size(), 2U);
  EXPECT_TRUE(sheared.stages[0].goes_to_mean());
  EXPECT_NEAR(*sheared.stages[0].target_stress(), 2e6 / 3.0, 1.0);
  EXPECT_EQ(sheared.stages[1].record.kind, StageKind::shear);
  EXPECT_EQ(sheared.stages[1].axis[2].value, 0.06);
}

TEST(RecipeStageScene, StagesThatCannotBeAreRefused) {
  expect_part(stage_refusal("[[stage]]\nkind = \"oedometric\"\nstress = \"2 GPa\"\n"), "allowed: up to 700 MPa");
  expect_part(
      stage_refusal("[[stage]]\nkind = \"oedometric\"\nstress = \"77 GPa\"\n", "start_pressure = \"50 kPaa\"\n"),
      "is 1.1 times E = 70 GPa");
  expect_part(stage_refusal("[[stage]]\nkind = \"oedometric\"\nstress = \"20 kPa\"\n"),
              "must be above the 50 kPa at which the preparation ends");
  expect_part(stage_refusal(kLoad, "start_pressure = 1e-4\n"), "must be above the 7 MPa");
  expect_part(stage_refusal("[[stage]]\nkind = \"oedometric\"\nstrain = 0.02\n"), "give stress");
  expect_part(stage_refusal("[[stage]]\nkind = \"isotropic\"\nstress = \"1 MPa\"\n"), "without lateral strain");
  expect_part(stage_refusal(std::string(kLoad) + "modulus_stress = [\"1 MPa\", \"2 MPa\"]\n"),
              "1 MPa to 2 MPa is outside the stage, which goes from 50 kPa to 1 MPa");
  expect_part(stage_refusal(std::string(kLoad) + "steps = 2\n"), "3 recorded points at least");
  expect_part(stage_refusal(kLoad, "start_pressure = \"50 kPa\"\n", "[test]\nstrain = 0.05\n"),
              "goes without [[stage]]");
  expect_part(stage_refusal(std::string(kLoad) + "modulus_stress = [\"0.5 MPa\", \"1 MPa\"]\n",
                            "start_pressure = \"50 kPa\"\n", "[test]\nmodulus_stress = [\"0.1 MPa\", \"0.2 MPa\"]\n"),
              "every [[stage]] gives its own");
  // The interval of a reload ends where its unloading began.
  expect_part(stage_refusal(std::string(kLoad) +
                            "[[stage]]\nkind = \"unload\"\nstress = \"0.2 MPa\"\n[[stage]]\nkind = \"reload\"\n"
                            "modulus_stress = [\"0.5 MPa\", \"1.5 MPa\"]\n"),
              "goes from 200 kPa to 1 MPa");
  expect_part(stage_refusal(kLoad, "start_pressure = \"1 GPa\"\n"), "allowed: from 1e-15 to 0.01 E");
}

TEST(StartPressure, StaysAPressureWhereAVariantHasAnotherModulus) {
  const auto read = [](const std::string& start) {
    return read_material_scene(Scene::parse("kind = \"material\"\n[material]\nE = \"70 GPa\"\n[grains]\ncount = 300\n"
                                            "ratio = 2\n[packing]\nstart_pressure = " +
                                                start +
                                                "\n[[variant]]\nname = \"a\"\n[[variant]]\nname = \"b\"\nE = "
                                                "\"7 GPa\"\n[[variant]]\nname = \"c\"\nstart_pressure = 1e-3\n",
                                            "s"))
        .variants;
  };
  const auto by_pressure = read("\"70 kPa\"");
  EXPECT_DOUBLE_EQ(by_pressure[0].setup.spec.start_pressure, 1e-6);
  EXPECT_DOUBLE_EQ(by_pressure[1].setup.spec.start_pressure, 1e-5);
  EXPECT_EQ(by_pressure[2].setup.spec.start_pressure, 1e-3);
  const auto by_number = read("2e-4");
  EXPECT_EQ(by_number[1].setup.spec.start_pressure, 2e-4);
}

TEST(Preparations, PlacingIsFrictionWhileCompacting) {
  const PreparationProtocol poured = protocol_of(Preparation::poured, 0.5);
  EXPECT_EQ(poured.friction, 0.5);
  EXPECT_EQ(poured.inertial_number, protocol_of(Preparation::fast, 0.5).inertial_number);
  EXPECT_EQ(protocol_of(Preparation::rodded, 0.5).friction, kRoddedFriction);
  EXPECT_EQ(protocol_of(Preparation::rodded, 0.05).friction, 0.05);
  const PreparationProtocol vibrated = protocol_of(Preparation::vibrated, 0.5);
  EXPECT_EQ(vibrated.friction, 0.0);
  EXPECT_EQ(vibrated.first_pressure, protocol_of(Preparation::frictionless, 0.5).first_pressure);
}

TEST(StateCurves, StateAndSolidFractionAreInverse) {
  for (const StateForm form : {StateForm::porosity, StateForm::pores}) {
    EXPECT_NEAR(state_of_phi(form, 0.6, 0.6), 0.0, 1e-15);
    EXPECT_NEAR(phi_of_state(form, 0.6, 0.0), 0.6, 1e-15);
    for (const double phi : {0.55, 0.61, 0.7}) {
      EXPECT_NEAR(phi_of_state(form, 0.6, state_of_phi(form, 0.6, phi)), phi, 1e-14);
      if (phi > 0.6) {
        EXPECT_NEAR(state_pressure(form, 0.05, 1.5, 0.6, phi), 0.05 * std::pow(state_of_phi(form, 0.6, phi), 1.5),
                    1e-15);
      }
    }
  }
}

TEST(CompressionIndex, IsTheSlopeOverDecadesOfStress) {
  std::vector<double> stress{1e5, 2e5, 5e5, 1e6};
  std::vector<double> e;
  for (const double s : stress) e.push_back(0.7 - 0.12 * std::log10(s / 1e5));
  EXPECT_NEAR(compression_index(e, stress, 1e5, 1e6), 0.12, 1e-12);
  EXPECT_NEAR(compression_index(e, stress, 2e5, 5e5), 0.12, 1e-12);
  EXPECT_TRUE(std::isnan(compression_index(e, stress, 1e5, 2e6)));
  std::reverse(stress.begin(), stress.end());
  std::reverse(e.begin(), e.end());
  EXPECT_NEAR(compression_index(e, stress, 1e6, 1e5), 0.12, 1e-12);  // an unloading: Cs
}

/// Packings on e = e_1 - Cc log10(s) and back on Cs, with onset phi_J: x follows.
StatePaths log_paths(const std::vector<double>& cc, double onset) {
  StatePaths paths;
  paths.stages = {{"load", StageKind::oedometric, StageKind::oedometric, {2e5, 1e6}},
                  {"unload", StageKind::unload, StageKind::oedometric, {}}};
  const std::vector<double> stress{1e5, 2e5, 5e5, 1e6, 5e5, 1e5};
  paths.stage = {0, 0, 0, 0, 1, 1};
  for (const double c : cc) {
    StatePath p{"a", {}, stress, {}};
    for (std::size_t k = 0; k < stress.size(); ++k) {
      const double turn = 0.62 - c;  // at 1 MPa
      const double e = k <= 3 ? 0.62 - c * std::log10(stress[k] / 1e5) : turn - 0.01 * std::log10(stress[k] / 1e6);
      p.state.push_back(state_of_phi(paths.form, onset, 1.0 / (1.0 + e)));
      p.lateral.push_back(0.4 * stress[k]);
    }
    paths.packings.push_back(p);
  }
  return paths;
}

TEST(RecipeStages, GiveModulusIndexAndK0OfAKnownCurve) {
  constexpr double kOnset = 0.6;
  constexpr double kIndex = 0.05;
  const StatePaths paths = log_paths({kIndex}, kOnset);
  const RecipeStages all = whole_under_stages(paths, {kOnset, 0.001, 0.598, 0.602});
  ASSERT_EQ(all.stages.size(), 2U);
  ASSERT_EQ(all.points.size(), 6U);
  const RecipeStageSummary& load = all.stages[0];
  EXPECT_NEAR(load.index.predicted.value, kIndex, 1e-9);
  EXPECT_STREQ(load.index_name(), "Cc");
  EXPECT_NEAR(load.stress_from, 2e5, 1e-3);
  EXPECT_NEAR(load.stress_to, 1e6, 1e-3);
  EXPECT_NEAR(load.stress_end, 1e6, 1e-3);
  const auto e_at = [&](double s) { return 0.62 - kIndex * std::log10(s / 1e5); };
  EXPECT_NEAR(load.secant.predicted.value, 8e5 / std::log((1.0 + e_at(2e5)) / (1.0 + e_at(1e6))), 1.0);
  EXPECT_NEAR(load.lateral_ratio.predicted.value, 0.4, 1e-12);
  EXPECT_NEAR(load.void_ratio.predicted.value, e_at(1e6), 1e-12);
  EXPECT_EQ(all.stages[1].index.predicted.value > 0.0, true);
  EXPECT_NEAR(all.stages[1].index.predicted.value, 0.01, 1e-9);
  EXPECT_STREQ(all.stages[1].index_name(), "Cs");
  EXPECT_NEAR(all.points[3].strain.value, 1.0 - (1.0 + e_at(1e6)) / (1.0 + e_at(1e5)), 1e-12);
  EXPECT_NEAR(all.points[0].strain.value, 0.0, 1e-15);
  // The ends of the onset are those of the void ratio.
  const Estimate& e = load.void_ratio.predicted;
  const auto e_for = [&](double onset) {
    return 1.0 / phi_of_state(paths.form, onset, paths.packings[0].state[3]) - 1.0;
  };
  EXPECT_NEAR(e.low, e_for(0.602), 1e-12);
  EXPECT_NEAR(e.high, e_for(0.598), 1e-12);
  EXPECT_LT(load.secant.predicted.low, load.secant.predicted.value);
  EXPECT_GT(load.secant.predicted.high, load.secant.predicted.value);
  const RecipeCurve curve = curve_of_stages(all, 7e10);
  EXPECT_NEAR(curve.axial[3], 1e6 / 7e10, 1e-12);
  EXPECT_NEAR(curve.lateral[3], 4e5 / 7e10, 1e-12);
  EXPECT_NEAR(lateral_ratio(shape_of_stages(all)).value, 0.4, 1e-12);
}

TEST(RecipeStages, IntervalsHoldTheScatterOfPackingsAndAreMissingWithoutOneOfTheOnset) {
  const StatePaths paths = log_paths({0.04, 0.05, 0.06}, 0.6);
  const RecipeStages all = whole_under_stages(paths, {0.6, 1e-10, 0.6 - 1e-10, 0.6 + 1e-10});
  const Estimate& index = all.stages[0].index.predicted;
  EXPECT_NEAR(index.value, 0.05, 1e-9);
  EXPECT_NEAR(index.high - index.value, kNormal95 * 0.01, 1e-6);
  EXPECT_NEAR(index.value - index.low, kNormal95 * 0.01, 1e-6);
  const RecipeStages bare = whole_under_stages(paths, {0.6, kInfinity, -kInfinity, kInfinity});
  EXPECT_NEAR(bare.stages[0].index.predicted.value, 0.05, 1e-9);
  EXPECT_TRUE(std::isinf(bare.stages[0].index.predicted.high));
  const Estimate ratio = lateral_ratio(shape_of_stages(bare));  // as for the card: not known, and not without error
  EXPECT_NEAR(ratio.value, 0.4, 1e-12);
  EXPECT_TRUE(std::isinf(ratio.standard_error));
  EXPECT_TRUE(std::isinf(ratio.low) && std::isinf(ratio.high));
  const TextTable table = stages_table(bare);
  ASSERT_EQ(table.rows.size(), 6U);
  EXPECT_EQ(table.rows[3][0], "load");
  EXPECT_EQ(table.rows[3][1], "1000000");
  EXPECT_EQ(table.rows[3][4], "");
}

/// Packings of grains half as stiff as the mean of the whole were loaded to half of its stresses.
TEST(RecipeStages, PackingsBearOverTheModulusOfTheWhole) {
  RecipeScene scene = read_staged(kLoad);
  StateFit states;
  std::vector<VariantResult> results;
  for (MaterialVariant& v : scene.material.variants) {
    v.setup.spec.youngs_modulus = 0.5 * scene.youngs_modulus;
    states.groups.push_back({v.name, 1.0, 1, 2, {0.6, 0.001, 0.598, 0.602}});
    MacroCurve c;
    c.usable = true;
    c.stages = {{"load", StageKind::oedometric, StageKind::oedometric, {2e5, 1e6}}};
    const auto points = static_cast<std::size_t>(recorded_points(v.setup.spec));
    c.stage.assign(points, 0.0);
    for (std::size_t k = 0; k < points; ++k) {
      c.strain.push_back(0.001 * static_cast<double>(k));
      c.more[kSolidFraction].push_back(0.61 + 0.001 * static_cast<double>(k));
      c.stress_axial.push_back(1e5 * static_cast<double>(k + 1));
      c.stress_lateral.push_back(4e4 * static_cast<double>(k + 1));
    }
    results.push_back({&v, "", {c}, nullptr});
  }
  const StatePaths paths = paths_of(scene, results, states);
  ASSERT_FALSE(paths.packings.empty());
  for (const StatePath& p : paths.packings) {
    EXPECT_DOUBLE_EQ(p.axial[1], 4e5) << p.name;
    EXPECT_DOUBLE_EQ(p.lateral[1], 1.6e5) << p.name;
    EXPECT_NEAR(p.state[1], state_of_phi(paths.form, 0.6, 0.611), 1e-12) << "states are of the density alone";
  }
  EXPECT_DOUBLE_EQ(paths.stages[0].modulus_stress[1], 2e6);
  scene.youngs_modulus *= 0.5;
  EXPECT_DOUBLE_EQ(paths_of(scene, results, states).packings.front().axial[1], 2e5);
}

/// The whole that answers as one packing is that packing again at its own onset.
TEST(RecipeStages, APackingCarriedToItsOwnOnsetIsItself) {
  for (const double onset : {0.58, 0.6}) {
    const StatePaths paths = log_paths({0.05}, onset);
    const MacroCurve c = carried_over(paths, paths.packings.front(), onset);
    EXPECT_NEAR(1.0 / c.more.at(kSolidFraction)[3] - 1.0, 0.57, 1e-12) << onset;
    EXPECT_EQ(c.stress_axial, paths.packings.front().axial);
    EXPECT_EQ(first_stage_of(c).strain.size(), 4U);
    EXPECT_EQ(first_stage_of(c).more.at(kSolidFraction).size(), 4U);
    EXPECT_EQ(first_stage_of(c).stages.size(), 1U);
  }
}

}  // namespace
}  // namespace softgrain
