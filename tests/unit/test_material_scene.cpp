// Scenes of kind "material": which variant is tested under which loading.
#include <gtest/gtest.h>

#include "common/core/error.h"
#include "pipelines/kinds/material/scene.h"

namespace softgrain {
namespace {

const std::string kLoadedMaterial = R"(kind = "material"
[grains]
count = 500
[test]
strain = 0.08
steps = 5
tolerance = 0.02
[[loading]]
name = "pressed"
[[loading]]
name = "sheared"
test = "shear"
strain = 0.06
[[loading]]
name = "staged"
tolerance = 0.01
[[loading.stage]]
kind = "isotropic"
strain = 0.01
)";

MaterialScene loaded_material(const std::string& more) {
  return read_material_scene(Scene::parse(kLoadedMaterial + more, "s"));
}

std::string complaint_of_loadings(const std::string& more) {
  try {
    (void)loaded_material(more);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

/// mu_r of all grains, of a variant or of none; kr_ratio goes with it.
TEST(MaterialScene, GrainsMayResistRolling) {
  const MaterialScene scene = loaded_material(
      "[material]\nmu_r = 0.1\n[[variant]]\nname = \"a\"\nkr_ratio = 2.0\n"
      "[[variant]]\nname = \"b\"\nmu_r = 0.0\n");
  EXPECT_EQ(scene.variants.front().setup.spec.rolling, (RollingResistance{0.1, 2.0, 1.0}));
  EXPECT_EQ(scene.variants.back().setup.spec.rolling, RollingResistance{});
  EXPECT_NE(family_of(scene.variants.front(), scene.variants).find("mu_r = 0.1, kr_ratio = 2"), std::string::npos);
  EXPECT_NE(complaint_of_loadings("[material]\nkr_ratio = 2.0\n").find("nothing resists rolling"), std::string::npos);
  EXPECT_NE(complaint_of_loadings("[material]\nmu = 0.0\nmu_r = 0.1\n").find("needs friction"), std::string::npos);
  EXPECT_NE(complaint_of_loadings("[material]\nmu_r = -0.1\n").find("mu_r"), std::string::npos);
}

TEST(MaterialScene, EveryVariantIsTestedUnderEveryLoadingOfItsPackings) {
  const MaterialScene scene = loaded_material(R"([[variant]]
name = "a"
[[variant]]
name = "b"
mu = 0.5
steps = 7
loadings = ["staged", "pressed"]
)");
  struct Expected {
    const char* name;
    const char* packings;
    bool same;
    MacroTest test;
    std::int64_t steps;
    double friction;
  };
  const Expected expected[] = {{"a-pressed", "a", false, MacroTest::oedometric, 5, 0.3},
                               {"a-sheared", "a", true, MacroTest::shear, 5, 0.3},
                               {"a-staged", "a", true, MacroTest::stages, 5, 0.3},
                               {"b-staged", "b", false, MacroTest::stages, 7, 0.5},
                               {"b-pressed", "b", true, MacroTest::oedometric, 7, 0.5}};
  ASSERT_EQ(scene.variants.size(), std::size(expected));
  for (std::size_t k = 0; k < std::size(expected); ++k) {
    const MaterialVariant& v = scene.variants[k];
    EXPECT_EQ(v.name, expected[k].name);
    EXPECT_EQ(v.packings, expected[k].packings) << v.name;
    EXPECT_EQ(v.same_packings, expected[k].same) << v.name;
    EXPECT_EQ(v.setup.spec.test, expected[k].test) << v.name;
    EXPECT_EQ(v.setup.spec.steps, expected[k].steps) << v.name;
    EXPECT_EQ(v.setup.spec.friction, expected[k].friction) << v.name;
  }
  EXPECT_EQ(scene.variants[1].setup.spec.strain_end, 0.06);
  EXPECT_EQ(scene.variants[0].setup.spec.strain_end, 0.08);
  EXPECT_EQ(scene.variants[2].setup.spec.stages.front().tolerance, 0.01);
  EXPECT_EQ(scene.variants[3].setup.spec.stages.front().steps, 7);
  EXPECT_EQ(scene.variants[4].setup.spec.tolerance, 0.02);
}

TEST(MaterialScene, WithoutVariantsResultsAreCalledAsTheirLoadings) {
  const MaterialScene scene = loaded_material("");
  ASSERT_EQ(scene.variants.size(), 3U);
  EXPECT_EQ(scene.variants[0].name, "pressed");
  EXPECT_EQ(scene.variants[2].name, "staged");
  EXPECT_EQ(scene.variants[2].packings, "material");
}

TEST(MaterialScene, NoTwoResultsShareAFile) {
  EXPECT_NE(complaint_of_loadings(
                "[[loading]]\nname = \"x-pressed\"\n[[variant]]\nname = \"a\"\n[[variant]]\nname = \"a-x\"\n")
                .find("'a-x-pressed' would be the name of two results"),
            std::string::npos);
  EXPECT_NE(complaint_of_loadings("[[loading]]\nname = \"initial\"\n").find("give another name"), std::string::npos);
}

/// [test] stands for all stages that name no stresses of their own, and a variant for its own.
TEST(MaterialScene, StressesOfModuliGoFromTablesToStages) {
  const MaterialScene scene = read_material_scene(Scene::parse(R"(kind = "material"
[grains]
count = 500
[test]
modulus_stress = [1e3, 2e3]
[[stage]]
kind = "oedometric"
strain = 0.02
[[stage]]
kind = "oedometric"
strain = 0.02
modulus_stress = [3e3, 4e3]
[[variant]]
name = "a"
[[variant]]
name = "b"
modulus_stress = [5e3, 6e3]
)",
                                                               "s"));
  const auto interval = [&](std::size_t variant, std::size_t stage) {
    return scene.variants.at(variant).setup.spec.stages.at(stage).record.modulus_stress[0];
  };
  EXPECT_EQ(interval(0, 0), 1e3);
  EXPECT_EQ(interval(0, 1), 3e3);
  EXPECT_EQ(interval(1, 0), 5e3);
  EXPECT_EQ(interval(1, 1), 3e3);
}

/// A stress is compared with E of the grains that are under it: with variants that is theirs.
TEST(MaterialScene, StressesAreComparedWithEOfTheVariant) {
  const auto refusal = [](const std::string& stage, const std::string& material, const std::string& variants) {
    const std::string head = "kind = \"material\"\n[grains]\ncount = 800\nratio = 3\n" + material;
    try {
      (void)read_material_scene(
          Scene::parse(head + stage + "kind = \"oedometric\"\nstress = \"5 MPa\"\n" + variants, "s"));
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const std::string variant = "[[variant]]\nname = \"a\"\n";
  const std::string glass = variant + "E = \"70 GPa\"\n";
  const std::string powder = "[[variant]]\nname = \"b\"\nE = \"1 MPa\"\n";
  for (const std::string stage : {"[[stage]]\n", "[[loading]]\nname = \"l\"\n[[loading.stage]]\n"}) {
    EXPECT_EQ(refusal(stage, "", glass), "");
    EXPECT_EQ(refusal(stage, "[material]\nE = \"70 GPa\"\n", ""), "");
    EXPECT_NE(refusal(stage, "", "").find("is 10 times E = 500 kPa"), std::string::npos);
    EXPECT_NE(refusal(stage, "", variant).find("is 10 times E = 500 kPa"), std::string::npos);
    const std::string one = refusal(stage, "[material]\nE = \"70 GPa\"\n", variant + powder);
    EXPECT_NE(one.find("is 5 times E = 1 MPa"), std::string::npos) << one;
    // What is wrong elsewhere hides no stress, and where E was refused stresses are not compared with another one.
    const std::string wrong = "[packing]\npreparation = \"fats\"\n";
    for (const std::string& variants : {std::string(), variant}) {
      const std::string both = refusal(stage, wrong, variants);
      EXPECT_NE(both.find("fats"), std::string::npos) << both;
      EXPECT_NE(both.find("is 10 times E = 500 kPa"), std::string::npos) << both;
    }
    const std::string no_modulus = refusal(stage, "[material]\nE = \"70 GPaa\"\n", variant);
    EXPECT_NE(no_modulus.find("GPaa"), std::string::npos) << no_modulus;
    EXPECT_EQ(no_modulus.find("times E"), std::string::npos) << no_modulus;
  }
  const std::string own = refusal(variant + "[[variant.stage]]\n", "[material]\nE = \"70 GPaa\"\n", "");
  EXPECT_NE(own.find("GPaa"), std::string::npos) << own;
  EXPECT_EQ(own.find("times E"), std::string::npos) << own;
}

/// Too few grains are refused before the run, by the key of this kind, with the number that would do.
TEST(MaterialScene, RefusesCellsWithoutRoomForImages) {
  const auto refusal = [](const std::string& count) -> std::string {
    try {
      (void)read_material_scene(Scene::parse("kind = \"material\"\n[grains]\ncount = " + count + "\n", "s"));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  const std::string text = refusal("60");
  for (const char* part :
       {"s:3: count", "60 grains are too few for a periodic cell", "or more have room", "[grains] count"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  for (const char* part : {"macro", "boundary"}) EXPECT_EQ(text.find(part), std::string::npos) << text;
  const auto at = text.find(" or more have room");
  const auto from = text.rfind(' ', at - 1);
  EXPECT_EQ(refusal(text.substr(from + 1, at - from - 1)), "") << text;  // so many do
}

}  // namespace
}  // namespace softgrain
