// Keys of common tables and of parts of scenes: what they change in what is run, and where they are refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "macrosim/test_protocol.h"
#include "pipelines/kinds/kinds.h"
#include "pipelines/kinds/macro/scene.h"
#include "pipelines/kinds/macro_comparison/scene.h"
#include "pipelines/kinds/material/scene.h"
#include "tests/support/every_kind.h"
#include "tests/support/keyed_scenes.h"
#include "tests/support/refusal.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

class KeysThatCount : public ::testing::Test {
 protected:
  KeysThatCount() { write_keyed_files(directory_); }
  [[nodiscard]] Scene scene(const std::string& text) const { return Scene::parse(text, directory_.file("s.toml")); }
  [[nodiscard]] MaterialScene material(const std::string& more) const {
    return read_material_scene(scene(kHead + more));
  }
  [[nodiscard]] MacroComparisonSetup comparison(const std::string& text, const std::string& more) const {
    return read_macro_comparison(scene(text + more));
  }
  void refused(const std::string& text, const std::string& words) const {
    const Scene s = scene(text);
    expect_refused<InputError>([&] { kind_of(s).read(s); }, words);
  }
  void refused_by_check(const std::string& text, const std::string& words) const {
    expect_refused<InputError>([&] { (void)warnings(text); }, words);
  }
  [[nodiscard]] std::vector<std::string> warnings(const std::string& text) const {
    Findings out;
    const Scene s = scene(text);
    kind_of(s).check(s, {}, out);
    return out.warnings();
  }

  inline static const std::string kHead = "kind = \"material\"\n[grains]\ncount = 80\nratio = 1.5\n";
  inline static const std::string kStages =
      "[[stage]]\nkind = \"isotropic\"\nstrain = 0.02\n[[stage]]\nkind = \"triaxial\"\nstrain = 0.02\nsteps = 9\n";
  TemporaryDirectory directory_;
};

TEST_F(KeysThatCount, AVariantsStepsAreThoseOfCommonStages) {
  const MaterialScene m = material(
      "[test]\nsteps = 3\n" + kStages +
      "[[variant]]\nname = \"a\"\n[[variant]]\nname = \"b\"\nsteps = 5\nincrements_per_step = 7\ntolerance = 1e-4\n");
  const auto stages = [&](std::size_t v) { return stages_of(m.variants.at(v).setup.spec); };
  EXPECT_EQ(stages(0)[0].steps, 3);
  EXPECT_EQ(stages(1)[0].steps, 5);
  EXPECT_EQ(stages(1)[1].steps, 9) << "said by the stage";
  EXPECT_EQ(stages(1)[0].increments_per_step, 7);
  EXPECT_EQ(stages(1)[1].increments_per_step, 7);
  EXPECT_EQ(stages(1)[0].tolerance, 1e-4);
}

TEST_F(KeysThatCount, AScenesStepsAreThoseOfCommonStages) {
  const auto c =
      comparison(comparison_stages(), "name = \"a\"\n[[scene]]\nname = \"b\"\nsteps = 5\ntolerance = 1e-4\n");
  EXPECT_EQ(stages_of(c.scenes.at(0).setup.spec)[0].steps, 3);
  EXPECT_EQ(stages_of(c.scenes.at(1).setup.spec)[0].steps, 5);
  EXPECT_EQ(stages_of(c.scenes.at(1).setup.spec)[1].tolerance, 1e-4);
}

TEST_F(KeysThatCount, KeysOfATestAreRefusedBesideCommonStages) {
  for (const char* key : {"strain = 0.1", "preload = 0.01", "preload_steps = 2"}) {
    refused(kHead + kStages + "[[variant]]\nname = \"a\"\n" + key + "\n", "the common [[stage]] say what is tested");
    refused(comparison_stages() + key + "\n", "the common [[stage]] say what is tested");
  }
  const MaterialScene m =
      material(kStages + "[[variant]]\nname = \"a\"\ntest = \"isotropic\"\nstrain = 0.1\n[[variant]]\nname = \"b\"\n");
  EXPECT_EQ(stages_of(m.variants.at(0).setup.spec).size(), 1U) << "a test of its own takes their place";
  refused(kHead + "[test]\nsteps = 3\n[[stage]]\nkind = \"isotropic\"\nstrain = 0.02\nsteps = 9\n",
          "every [[stage]] gives its own");
  refused(kHead + "[[variant]]\nname = \"a\"\nsteps = 4\n[[loading]]\nname = \"l\"\nsteps = 3\n",
          "each [[loading]] of this variant gives its own");
}

TEST_F(KeysThatCount, CommonStagesThatNoPartTakesAreRefused) {
  const std::string test = "test = \"isotropic\"\n";
  const std::string own = "[[variant.stage]]\nkind = \"oedometric\"\nstrain = 0.02\n";
  const std::string variants = "[[variant]]\nname = \"a\"\n" + test + "[[variant]]\nname = \"b\"\n";
  refused(kHead + kStages + variants + own, "no [[variant]] takes it");
  EXPECT_EQ(material(kStages + variants).variants.size(), 2U) << "b takes the common ones";
}

TEST_F(KeysThatCount, CommonKeysOfAPreparationThatLammpsMakesAreRefused) {
  const std::string head = "kind = \"material\"\n[grains]\ncount = 80\nratio = 1.5\n[packing]\nfirst_pressure = 4.0\n";
  const std::string a = "[[variant]]\nname = \"a\"\npreparation = \"lammps\"\n";
  refused(head + a, "LAMMPS has a protocol of its own");
  EXPECT_EQ(read_material_scene(scene(head + a + "[[variant]]\nname = \"b\"\n")).variants.size(), 2U);
}

TEST_F(KeysThatCount, WhatTheCommonTableSaysOfAPreparationStays) {
  const std::string common = "[packing]\npreparation = \"fast\"\ncompaction_mu = 0.05\npreparation_tolerance = 1e-3\n";
  for (const char* own : {"mu = 0.5\n", "preparation = \"slow\"\n"}) {
    const MaterialScene m = material(common + "first_pressure = 4\n[[variant]]\nname = \"a\"\n" + own);
    const PreparationProtocol& p = m.variants.at(0).setup.spec.protocol;
    EXPECT_EQ(p.friction, 0.05) << own;
    EXPECT_EQ(p.tolerance, 1e-3) << own;
    EXPECT_EQ(p.first_pressure, 4.0) << own;
  }
  const MaterialScene follows = material(
      "[packing]\npreparation = \"fast\"\n[[variant]]\nname = \"a\"\nmu = 0.5\n[[variant]]\nname = \"b\"\n"
      "preparation = \"slow\"\n");
  EXPECT_EQ(follows.variants.at(0).setup.spec.protocol.friction, 0.5) << "nobody said it";
  EXPECT_EQ(follows.variants.at(0).setup.spec.protocol.tolerance, 3e-3);
  EXPECT_EQ(follows.variants.at(1).setup.spec.protocol.inertial_number, 1e-3);
  const auto c = comparison(std::string(kTinyComparison)
                                .replace(std::string(kTinyComparison).find("bodies"), 0,
                                         "compaction_mu = 0.05\npreparation_tolerance = 1e-3\n"),
                            "[[scene]]\nname = \"c\"\nmu = 0.6\npreparation = \"frictionless\"\n");
  EXPECT_EQ(c.scenes.at(2).setup.spec.protocol.friction, 0.05);
  EXPECT_EQ(c.scenes.at(2).setup.spec.protocol.tolerance, 1e-3);
}

TEST_F(KeysThatCount, ASceneBelowACommonPackingMakesNoOther) {
  EXPECT_EQ(comparison(comparison_packing(), "").scenes.at(0).setup.spec.bodies, 27);
  for (const char* key : {"soft_share = 0.2", "bodies = 20", "soft_radius_max = 0.01", "solid_radius_max = 0.01",
                          "solid_polydispersity = 3.0", "start_pressure = 1e-4", "preparation = \"fast\"",
                          "construction = \"voids\"", "exponent = 3.0"})
    refused(comparison_packing() + key + "\n", "goes without the common packing");
  refused(comparison_packing() + "boundary = \"periodic\"\n", "is that of the common packing");
  refused(comparison_packing() + "samples = 2\n", "a packing is one sample");
}

/// Sizes of a kind of body of which there is none; a common table has them for whichever scene does.
TEST_F(KeysThatCount, SizesOfBodiesThatAreNotThereAreRefused) {
  const std::string macro = "kind = \"macro\"\n[macro]\nresolved = false\n";
  for (const char* key : {"radius_max = 0.01", "polydispersity = 3.0"}) {
    refused(macro + "soft_share = 0.0\nsoft_" + key + "\n", "goes with soft_share above 0");
    refused(macro + "soft_share = 1.0\nsolid_" + key + "\n", "goes with soft_share below 1");
    EXPECT_NO_THROW((void)read_macro_scene_alone(scene(macro + "soft_share = 0.0\nsolid_" + key + "\n")));
    EXPECT_NO_THROW((void)read_macro_scene_alone(scene(macro + "soft_share = 1.0\nsoft_" + key + "\n")));
  }
  refused(macro + "soft_share = 0.0\nsoft_sizes = {form = \"list\", radii = [0.01, 0.012]}\n",
          "goes with soft_share above 0");
  const std::string tiny = kTinyComparison;  // its [macro] gives sizes of soft particles
  EXPECT_NO_THROW((void)comparison(tiny, "[[scene]]\nname = \"none\"\nsoft_share = 0.0\n"));
  refused(tiny + "[[scene]]\nname = \"none\"\nsoft_share = 0.0\nsoft_radius_max = 0.01\n",
          "goes with soft_share above 0");
  std::string no_soft = tiny;
  no_soft.replace(no_soft.find("soft_share = 0.35"), 17, "soft_share = 0.0");
  refused(no_soft, "goes with soft_share above 0");
}

/// A mistake elsewhere hid them until it was mended.
TEST_F(KeysThatCount, StressesAboveEAreSaidBesideOtherMistakes) {
  const std::string stage = "[[stage]]\nkind = \"oedometric\"\nstress = \"5 MPa\"\n";
  const std::string macro = "[macro]\nbodies = 0\n";
  const std::string cells = "kind = \"macro\"\nlaw = \"cells.toml\"\n[fines]\nshare = 0.3\n[material]\nE = \"1 MPa\"\n";
  const std::string pipeline = std::string(kTinyPipeline).substr(0, std::string(kTinyPipeline).find("[macro]"));
  const std::string comparison =
      "kind = \"macro-comparison\"\n[material]\nE = \"1 MPa\"\n[law]\ncard = \"law.toml\"\n[[scene]]\nstpes = 3\n";
  for (const std::string& text : {cells, pipeline, comparison}) {
    refused(text + macro + stage, "bodies = 0");
    refused(text + macro + stage, text == pipeline ? "is 10 times E = 500 kPa" : "is 5 times E = 1 MPa");
    // Where E was refused there is none to compare with.
    std::string no_modulus = text + "[macro]\n" + stage;
    no_modulus.replace(no_modulus.find(" MPa\""), 5, " MPaa\"");
    const Scene s = scene(no_modulus);
    try {
      kind_of(s).read(s);
      ADD_FAILURE() << no_modulus;
    } catch (const InputError& e) {
      EXPECT_NE(std::string(e.what()).find("MPaa"), std::string::npos) << e.what();
      EXPECT_EQ(std::string(e.what()).find("times E"), std::string::npos) << e.what();
    }
  }
  EXPECT_NO_THROW((void)read_macro_scene_alone(scene("kind = \"macro\"\n[macro]\nresolved = false\n" + stage)))
      << "E is that of the law, which is not there";
}

TEST_F(KeysThatCount, ALawTableHasOneTangentialStiffness) {
  const std::string table =
      std::string("table = \"") + SOFTGRAIN_SOURCE_DIR + "/tests/reference/law/two_fractions.toml\"\n";
  const std::string tiny = kTinyComparison;
  const auto by = [&](const std::string& laws, const std::string& common) {
    std::string text = tiny;
    text.replace(text.find("card = \"law.toml\"\n"), 18, laws);
    return text.insert(text.find("steps = 3"), common);
  };
  const std::string kt = "kt = \"initial\"\n";
  refused(by(table, kt), "a law table has one tangential stiffness");
  refused(by(table, "") + "[[scene]]\nname = \"c\"\n" + kt, "a law table has one tangential stiffness");
  EXPECT_FALSE(comparison(by("card = \"law.toml\"\n", kt), "").scenes.at(0).setup.spec.kt_secant);
  EXPECT_FALSE(comparison(by(table + "card = \"law.toml\"\n", kt), "").scenes.at(0).setup.spec.kt_secant);
  const std::string own = "[[scene]]\nname = \"c\"\n" + kt + "law = {card = \"law.toml\"}\n";
  EXPECT_FALSE(comparison(by(table, kt), own).scenes.at(2).setup.spec.kt_secant) << "one scene has a card";
}

/// Runs in LAMMPS are made once.
TEST_F(KeysThatCount, NoiseOfRunsInLammpsIsRefused) {
  const std::string text =
      "kind = \"macro\"\nlaw = \"law.toml\"\n[macro]\nresolved = false\npreparation = \"lammps\"\n";
  refused_by_check(text + "noise_samples = 1\n", "LAMMPS runs each sample once");
  EXPECT_NO_THROW((void)warnings(text + "bodies = 60\n"));
}

TEST_F(KeysThatCount, KeysOfAnotherTestOrLawAreRefused) {
  const std::string macro = "kind = \"macro\"\n[macro]\nresolved = false\n";
  refused(macro + "preload = 0.02\n", "goes with test = \"shear\", \"undrained\"");
  refused(macro + "test = \"shear\"\npreload_steps = 3\n", "goes with preload");
  refused(macro + "twin_speed = 1e-4\n", "goes with a resolved twin");
  refused(comparison_stages() + "band_estimator = \"draws\"\n", "goes with bands");
  EXPECT_NO_THROW((void)comparison(comparison_stages() + "bands = 0\nband_estimator = \"draws\"\n", "name = \"a\"\n"))
      << "0 switches bands off, whatever else is said of them";
  refused(comparison_stages() + "[scene.law]\ncard = \"law.toml\"\n", "every [[scene]] has a law of its own");
  refused(macro + "solid_fill = 0.3\n", "goes with construction = \"voids\"");
  const std::string between = "modulus_stress = [\"1 kPa\", \"2 kPa\"]\n";
  const std::string stage = "[[stage]]\nkind = \"oedometric\"\nstrain = 0.02\n";
  refused(macro + between + stage + between, "every [[stage]] gives its own");
  refused(kHead + "[[variant]]\nname = \"a\"\n" + between + "[[loading]]\nname = \"press\"\n" + between,
          "each [[loading]] of this variant gives its own");
  const std::string powder = kTinyPowder;
  for (const char* key : {"rolling_stiffness = 1e-4", "rolling_friction = 0.1"})
    refused(std::string(powder).replace(powder.find("kappa"), 0, key + std::string("\n")), "goes with rolling = true");
  const std::string soft = "kind = \"soft-particle\"\n[measure.soft_solid]\ndeltas = [0.1, 0.2]\n";
  refused(soft + "tangential_deltas = [0.2]\n", "goes with angles_deg");
  refused(soft + "[measure]\nrotation_step_deg = 0.02\n", "goes with angles_deg");
  refused(soft + "[measure]\nturn_speed = 0.001\n", "goes with angles_deg");
  refused(soft + "angles_deg = [-0.05, 0.05]\n[measure]\nrotation = \"cumulative\"\n", "two angles of one sign");
  refused(soft + "[measure]\nturn_speed = 1.0\n", "turn_speed = 1: must be from");
  refused(soft + "[measure.damped]\nincrement = 0.01\n", "goes with relaxation = \"damped\"");
  refused(soft + "[packing]\nrmax = 0.004\nrmax_over_shell = 0.3\n", "rmax_over_shell = 0.3: contradicts rmax");
}

TEST_F(KeysThatCount, RadiiInMetresByMistakeAreMinded) {
  const auto minds = [&](const std::string& text) {
    const std::vector<std::string> all = warnings(text);
    return std::any_of(all.begin(), all.end(),
                       [](const std::string& w) { return w.find("are metres") != std::string::npos; });
  };
  const std::string ball =
      "kind = \"particles\"\n[material.a]\ndensity = 2500.0\nE = \"1 MPa\"\nnu = 0.3\n[[contact]]\n"
      "pair = [\"a\", \"a\"]\nlaw = \"hertz-tsuji\"\nrestitution = 0.5\nmu = 0.3\n[time]\nend = 1e-3\n"
      "[[particle]]\nmaterial = \"a\"\nposition = [0, 0, 0]\nradius = ";
  EXPECT_TRUE(minds(ball + "16\n"));
  EXPECT_FALSE(minds(ball + "0.016\n"));
  const std::string sizes =
      "[grains.sizes]\nform = \"log-normal\"\nradius_median = 12\ngeometric_deviation = 1.3\n"
      "radius_min = 9\nradius_max = ";
  EXPECT_TRUE(minds("kind = \"material\"\n[grains]\ncount = 80\n" + sizes + "16\n"));
  EXPECT_FALSE(minds("kind = \"material\"\n[grains]\ncount = 80\nratio = 1.5\n"));
}

TEST_F(KeysThatCount, FamiliesOfMaterialsDifferInTheSpanAlone) {
  const auto families = [&](const std::string& variants, const std::string& head = kHead) {
    const MaterialScene m = read_material_scene(scene(head + variants));
    std::set<std::string> out;
    for (const MaterialVariant& v : m.variants) out.insert(family_of(v, m.variants));
    return out.size();
  };
  const std::string two = "[[variant]]\nname = \"a\"\nratio = 1.4\n[[variant]]\nname = \"b\"\nratio = 2.0\n";
  EXPECT_EQ(families(two), 1U);
  EXPECT_EQ(families(two + "count = 200\nsamples = 3\n"), 1U) << "how many there are does not matter";
  for (const char* key :
       {"nu = 0.2", "start_pressure = 1e-3", "compaction_mu = 0.1", "exponent = 3.0", "mu = 0.5", "E = 1e6",
        "start_fraction = 0.2", "test = \"isotropic\"", "strain = 0.1", "preparation = \"slow\"", "tolerance = 1e-3",
        "preparation_tolerance = 1e-3", "first_pressure = 8.0"})
    EXPECT_EQ(families(two + key + "\n"), 2U) << key;
  const MaterialScene loaded = material(
      two + "[[loading]]\nname = \"press\"\n[[loading]]\nname = \"shear\"\ntest = \"shear\"\nforce_floor = 1e-6\n");
  for (const MaterialVariant& v : loaded.variants)
    EXPECT_EQ(material_family(v, loaded.variants), material_family(loaded.variants.front(), loaded.variants));
  EXPECT_EQ(families(two + "[[loading]]\nname = \"press\"\n"), 1U);
  for (const char* key : {"tolerance = 1e-3\n", "steps = 3\n", "increments_per_step = 7\n", "force_floor = 1e-5\n"})
    EXPECT_EQ(families(two + key + "[[loading]]\nname = \"press\"\n"), 2U) << key;
  const std::string law = "sizes = { form = \"power-law\", exponent = 3.5, radius_min = 0.01, radius_max = 0.02 }\n";
  EXPECT_EQ(families(two + "[[variant]]\nname = \"c\"\n" + law), 1U) << "b = 3.5, said in another way";
  const auto normal = [](double deviation, double smallest) {
    return fmt::format(
        "sizes = {{ form = \"log-normal\", radius_median = 0.012, geometric_deviation = {}, "
        "radius_min = {}, radius_max = 0.016 }}\n",
        deviation, smallest);
  };
  const std::string a = "[[variant]]\nname = \"a\"\n" + normal(1.3, 0.009) + "[[variant]]\nname = \"b\"\n";
  EXPECT_EQ(families(a + normal(1.3, 0.008)), 1U);
  EXPECT_EQ(families(a + normal(1.4, 0.008)), 2U);
}

TEST_F(KeysThatCount, AFastPlaneIsWarnedOfInInverseScenesToo) {
  const std::string damped = "relaxation = \"damped\"\n[measure.damped]\nincrement = 0.02\ntolerance = 1e-2\n";
  const auto approach = [&](const std::string& speed) {
    const std::string slow = "relaxation = \"slow-dynamics\"\n[measure.least_work]\napproach_speed = ";
    const auto said = warnings(with_part(starter_scene("inverse"), damped, slow + speed + "\n"));
    return std::ranges::count_if(
        said, [](const std::string& one) { return one.find("waves rearrange the grains") != std::string::npos; });
  };
  EXPECT_EQ(approach("3.0"), 1);
  EXPECT_EQ(approach("1.0"), 0);
}

}  // namespace
