// Scenes of kind "material-law": the packings that they make of a material, and what is refused. Parts of gradings.
#include <gtest/gtest.h>

#include <cmath>

#include "common/core/error.h"
#include "common/packing/grading.h"
#include "pipelines/kinds/material_law/memory_fit.h"
#include "pipelines/kinds/material_law/scene.h"

namespace softgrain {
namespace {

constexpr double kWhole = 1e9;

std::vector<Grading> all_forms() {
  return {Grading::power_law(3.5, 1.0, 6.0),
          Grading::fuller(0.4, 1.0, 6.0),
          Grading::log_normal(2.5, 1.7, 1.0, 6.0),
          Grading::classes({{1.0, 2.5, 3.0, 0.3}, {2.0, 6.0, 4.0, 0.5}, {3.0, 3.0, 4.0, 0.2}}),
          Grading::sieve_curve({1.0, 2.0, 4.0, 6.0}, {0.0, 0.2, 0.7, 1.0}),
          Grading::list({1.0, 1.5, 2.0, 3.0, 6.0})};
}

/// Both parts together are the whole again, and neither reaches across the cut.
TEST(GradingParts, AreExactForEveryForm) {
  for (const Grading& whole : all_forms()) {
    const double cut = 2.0;
    const auto fines = pieces_between(whole, 0.0, cut);
    const auto coarse = pieces_between(whole, cut, kWhole);
    const Grading again = mixture_of(coarse, fines, whole.passing(cut));
    for (const double r : {1.1, 1.5, 1.99, 2.01, 2.6, 3.01, 5.9})
      EXPECT_NEAR(again.passing(r), whole.passing(r), 1e-12) << to_string(whole.form()) << " " << r;
    EXPECT_LE(Grading::classes(fines).largest(), cut) << to_string(whole.form());
    EXPECT_GE(Grading::classes(coarse).smallest(), cut) << to_string(whole.form());
    const Grading other = mixture_of(coarse, fines, 0.3);
    EXPECT_NEAR(other.passing(cut), 0.3, 1e-12);
    EXPECT_NEAR(other.passing(1.5), 0.3 * whole.passing(1.5) / whole.passing(cut), 1e-12);
  }
}

TEST(GradingParts, AreEmptyBeyondTheEnds) {
  for (const Grading& whole : all_forms()) {
    EXPECT_TRUE(pieces_between(whole, 0.0, 1.0).empty()) << to_string(whole.form());
    EXPECT_TRUE(pieces_between(whole, 6.01, kWhole).empty()) << to_string(whole.form());
  }
  // Grains of just the size of the cut are coarse.
  EXPECT_EQ(pieces_between(Grading::list({1.0, 2.0}), 0.0, 2.0).size(), 1U);
  EXPECT_EQ(pieces_between(Grading::list({1.0, 2.0}), 2.0, kWhole).size(), 1U);
}

MaterialLawScene read_law_scene(const std::string& more, const std::string& grains = "count = 600\nratio = 6") {
  return read_material_law_scene(Scene::parse(
      "kind = \"material-law\"\n[grains]\n" + grains + "\n[packing]\npreparation = \"fast\"\n" + more, "s"));
}

TEST(MaterialLawScene, MakesFinesCoarseGrainsAndMixtures) {
  const MaterialLawScene scene = read_law_scene("[law]\nmixtures = [0.25, 0.5, 0.75]\nshear_strain = 0.05\n");
  const auto& variants = scene.material.variants;
  ASSERT_EQ(variants.size(), 6U);
  const auto sizes = [&](std::size_t k) { return *variants[k].setup.spec.solid_sizes; };
  EXPECT_NEAR(sizes(0).smallest(), 0.016 / 6.0, 1e-12);
  EXPECT_NEAR(sizes(0).largest(), 0.016 / 3.0, 1e-12);
  EXPECT_EQ(sizes(1), sizes(0));
  EXPECT_TRUE(variants[1].same_packings);
  EXPECT_EQ(variants[1].setup.spec.test, MacroTest::shear);
  EXPECT_EQ(variants[1].setup.spec.strain_end, 0.05);
  EXPECT_EQ(variants[1].setup.spec.preload, 0.02);
  EXPECT_NEAR(sizes(2).smallest(), 0.016 / 3.0, 1e-12);
  EXPECT_NEAR(sizes(2).largest(), 0.016, 1e-12);
  for (std::size_t k = scene.at.first_mixture; k < variants.size(); ++k) {
    const MaterialVariant& v = variants[k];
    EXPECT_EQ(v.setup.spec.test, MacroTest::oedometric);
    EXPECT_FALSE(v.same_packings);
    const GrainShares shares = shares_of(scene, v, 1, 0);
    EXPECT_EQ(shares.coarse + shares.fines, 600);
    const double share = shares.fines_volume / (shares.fines_volume + shares.coarse_volume);
    EXPECT_NEAR(share, scene.mixtures[k - scene.at.first_mixture], 0.05) << v.name;
  }
  EXPECT_EQ(variants[3].name, "mix-25");
}

/// With shear memory all packings are compressed isotropically, and the fines, loose and dense, are tested further.
TEST(MaterialLawScene, WithShearMemoryTestsFinesInMoreWays) {
  const MaterialLawScene scene =
      read_law_scene("[law]\nmemory = true\nmixtures = [0.25, 0.5, 0.75]\nisotropic_strain = 0.025\n");
  const auto& variants = scene.material.variants;
  const auto name = [&](std::size_t k) { return variants.at(k).name; };
  ASSERT_EQ(variants.size(), 13U);
  EXPECT_EQ(name(scene.at.fines), "fines");
  EXPECT_EQ(name(scene.at.coarse), "coarse");
  EXPECT_EQ(name(scene.at.oedometer), "fines-oedometric");
  EXPECT_EQ(name(scene.at.first_mixture), "mix-25");
  std::vector<std::string> tests;
  for (const std::size_t k : scene.at.shear_tests) tests.push_back(name(k));
  EXPECT_EQ(tests, (std::vector<std::string>{"fines-oedometric", "fines-triaxial", "fines-preload-triaxial",
                                             "fines-preload-shear", "fines-dense-triaxial",
                                             "fines-dense-preload-triaxial", "fines-dense-preload-shear"}));
  for (const MaterialVariant& v : variants) {
    const bool test = v.name.starts_with("fines-") && v.name != "fines-dense";
    EXPECT_EQ(v.same_packings, test) << v.name;
    EXPECT_EQ(v.setup.spec.test, test ? MacroTest::stages : MacroTest::isotropic) << v.name;
    EXPECT_EQ(v.setup.spec.preparation, v.name.starts_with("fines-dense") ? Preparation::dense : Preparation::fast);
    if (!test) {
      EXPECT_EQ(v.setup.spec.strain_end, 0.025) << v.name;
    }
  }
  const MacroSpec& triaxial = variants.at(scene.at.shear_tests[2]).setup.spec;
  ASSERT_EQ(triaxial.stages.size(), 2U);
  EXPECT_EQ(triaxial.stages[0].axis[0].value, 0.02);
  EXPECT_TRUE(triaxial.stages[1].axis[1].by_stress);
  EXPECT_EQ(triaxial.stages[1].axis[1].as_at, 1);
  EXPECT_FALSE(triaxial.stages[1].axis[2].by_stress);
  const MacroSpec& oedometer = variants.at(scene.at.oedometer).setup.spec;
  EXPECT_EQ(oedometer.stages[0].axis[2].value, 0.08);
  EXPECT_EQ(oedometer.stages[1].axis[2].value, -0.02);
  EXPECT_EQ(oedometer.stages[1].record.kind, StageKind::unload);
  const MaterialLawScene loose = read_law_scene("[law]\nmemory = true\ndense = false\nmixtures = [0.25, 0.5, 0.75]\n");
  EXPECT_EQ(loose.material.variants.size(), 9U);
}

/// The fit strains its cells in parts of one size, however many points are recorded: 67 and 79 s of one core with 12
/// and 3 points a stage, both samples of seven tests. Four numbers take a third of the evaluations of seven.
TEST(MaterialLawScene, TheFitOfShearMemoryTakesAsLongAsItsStrains) {
  const auto seconds = [](const std::string& keys, const std::string& test) {
    return memory_fit_seconds(
        read_law_scene("[law]\nmemory = true\nmixtures = [0.25, 0.5, 0.75]\n" + keys + "[test]\n" + test));
  };
  const double usual = seconds("", "steps = 12\n");
  EXPECT_NEAR(seconds("", "steps = 3\n") / usual, 1.0, 0.2);
  EXPECT_NEAR(seconds("", "steps = 12\nstrain = 0.16\n") / usual, 1.0, 0.1) << "triaxial tests take most of it";
  EXPECT_GT(usual / seconds("dense = false\n", "steps = 12\n"), 3.0);
}

/// Fines of other preparations: of the same grains, and with nothing but a start that is recorded.
TEST(MaterialLawScene, PreparesFinesInOtherWays) {
  const std::string mixtures = "mixtures = [0.25, 0.5, 0.75]\n";
  const MaterialLawScene scene = read_law_scene("[law]\npreparations = [\"slow\", \"dense\"]\n" + mixtures);
  const auto& variants = scene.material.variants;
  ASSERT_EQ(variants.size(), 8U);
  ASSERT_EQ(scene.at.preparations, (std::vector<std::size_t>{2, 3}));
  EXPECT_EQ(variants[scene.at.coarse].name, "coarse");
  EXPECT_EQ(variants[scene.at.first_mixture].name, "mix-25");
  EXPECT_EQ(variants[2].name, "fines-slow");
  EXPECT_EQ(variants[3].setup.spec.preparation, Preparation::dense);
  const MacroSpec& fines = variants[0].setup.spec;
  for (const std::size_t k : scene.at.preparations) {
    const MacroSpec& spec = variants[k].setup.spec;
    EXPECT_FALSE(variants[k].same_packings);
    EXPECT_EQ(spec.solid_sizes, fines.solid_sizes);
    EXPECT_EQ(spec.bodies, fines.bodies);
    EXPECT_EQ(spec.start_pressure, fines.start_pressure);
    EXPECT_EQ(spec.protocol.tolerance, fines.protocol.tolerance);
    EXPECT_EQ(spec.steps, 1);
    EXPECT_LT(spec.strain_end, 0.01);
  }
  EXPECT_NE(variants[2].setup.spec.protocol.inertial_number, fines.protocol.inertial_number);
  const MaterialLawScene remembers =
      read_law_scene("[law]\nmemory = true\npreparations = [\"dense\", \"slow\"]\n" + mixtures);
  EXPECT_EQ(remembers.material.variants.size(), 14U) << "dense fines are prepared once";
  ASSERT_EQ(remembers.at.preparations.size(), 2U);
  EXPECT_EQ(remembers.material.variants[remembers.at.preparations[0]].name, "fines-dense");
  EXPECT_EQ(remembers.material.variants[remembers.at.preparations[1]].name, "fines-slow");
  EXPECT_EQ(remembers.material.variants[remembers.at.first_mixture].name, "mix-25");
}

std::string refusal(const std::string& law, const std::string& grains = "count = 600\nratio = 6") {
  try {
    (void)read_law_scene(law, grains);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(MaterialLawScene, RefusesWhatGivesNoLaw) {
  EXPECT_NE(refusal("[law]\nsplit = 0.1\n").find("no grain is fine: the smallest radius is 0.167 of the largest"),
            std::string::npos)
      << refusal("[law]\nsplit = 0.1\n");
  for (const char* split : {"0.0", "1.0", "-0.3"})
    EXPECT_NE(refusal(std::string("[law]\nsplit = ") + split).find("above 0 and below 1"), std::string::npos) << split;
  const std::string none = refusal("[law]\nmixtures = [0.2, 0.5, 0.998]\n");
  EXPECT_NE(none.find("mix-99.8: none of 600 grains is coarse: more grains"), std::string::npos) << none;
  EXPECT_NE(refusal("[law]\nmixtures = [0.2, 0.5]\n").find("at least three shares"), std::string::npos);
  EXPECT_NE(refusal("[law]\nmixtures = [0.2, 0.5, 0.5]\n").find("must ascend"), std::string::npos);
  EXPECT_NE(refusal("[law]\ncells = 20\n").find("from 40"), std::string::npos);
  EXPECT_NE(refusal("[law]\nmemory = true\ncells = 80\n").find("fitted without cells"), std::string::npos);
  EXPECT_NE(refusal("[law]\nmemory = true\nform = \"pores\"\n").find("goes with \"porosity\""), std::string::npos);
  for (const char* key : {"dense = true", "isotropic_strain = 0.02", "triaxial_strain = 0.1", "unload_strain = 0.01"})
    EXPECT_NE(refusal(std::string("[law]\n") + key + "\n").find("goes with memory = true"), std::string::npos) << key;
  EXPECT_NE(refusal("[law]\npreparations = [\"slwo\"]\n").find("nearest is 'slow'"), std::string::npos)
      << refusal("[law]\npreparations = [\"slwo\"]\n");
  EXPECT_NE(refusal("[law]\npreparations = [\"fast\"]\n").find("whose factor is 1"), std::string::npos);
  EXPECT_NE(refusal("[law]\npreparations = [\"slow\", \"slow\"]\n").find("twice"), std::string::npos);
  EXPECT_NE(refusal("[law]\npreparations = [\"lammps\"]\n").find("kind = \"material\""), std::string::npos);
  EXPECT_NE(refusal("", "count = 30\nratio = 6").find("too few for a periodic cell"), std::string::npos)
      << refusal("", "count = 30\nratio = 6");
  EXPECT_NE(refusal("[[stage]]\nkind = \"hold\"\n").find("stage"), std::string::npos);
  EXPECT_EQ(
      refusal("", "count = 600\nsizes = { form = \"fuller\", exponent = 0.5, radius_min = 0.003, radius_max = 0.016 }"),
      "");
}

TEST(MaterialLawScene, WarnsOfFewGrains) {
  Findings findings;
  check_material_law(read_material_law_scene(Scene::parse(
                         "kind = \"material-law\"\n[grains]\ncount = 600\n[law]\nmixtures = [0.2, 0.5, 0.9]\n"
                         "[packing]\npreparation = \"fast\"\n",
                         "s")),
                     findings);
  std::string all;
  for (const std::string& w : findings.warnings()) all += w + "\n";
  EXPECT_NE(all.find("mix-90: only "), std::string::npos) << all;
  EXPECT_NE(all.find("one sample"), std::string::npos) << all;
  EXPECT_EQ(all.find("mix-20: only "), std::string::npos) << all;
}

}  // namespace
}  // namespace softgrain
