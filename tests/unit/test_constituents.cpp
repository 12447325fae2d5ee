// [[constituent]] with E, nu and mu of its own: what packings of a material and of a recipe are made of, and refusals.
#include <gtest/gtest.h>

#include <array>

#include "common/core/error.h"
#include "macrosim/macro_packing.h"
#include "pipelines/kinds/recipe/scene.h"
#include "pipelines/kinds/recipe/stages.h"

namespace softgrain {
namespace {

constexpr const char* kSandSizes =
    "sizes = { form = \"power-law\", exponent = 3.5, radius_min = \"1 mm\", radius_max = \"3 mm\" }\n";
constexpr const char* kFillerSizes =
    "sizes = { form = \"power-law\", exponent = 3.5, radius_min = \"0.4 mm\", radius_max = \"1.2 mm\" }\n";

/// Sand and filler with these keys of their own, and what else a scene of the kind says.
std::string mix_of(const std::string& kind, const std::string& sand, const std::string& filler,
                   const std::string& more = "") {
  return "kind = \"" + kind + "\"\n[grains]\ncount = 3000\n" + more +
         "[[constituent]]\nname = \"sand\"\nmass_share = 0.6\ndensity = 2600\n" + kSandSizes + sand +
         "[[constituent]]\nname = \"filler\"\nmass_share = 0.4\ndensity = 2600\n" + kFillerSizes + filler;
}

RecipeScene recipe_of(const std::string& text) { return read_recipe_scene(Scene::parse(text, "s")); }
MaterialScene material_of_mix(const std::string& text) { return read_material_scene(Scene::parse(text, "s")); }

std::string refusal_of(const std::string& text) {
  try {
    text.find("kind = \"recipe\"") != std::string::npos ? (void)recipe_of(text) : (void)material_of_mix(text);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

const std::string kStiff = "E = \"90 GPa\"\nnu = 0.1\nmu = 0.5\n";
const std::string kSoft = "E = \"30 GPa\"\nnu = 0.3\nmu = 0.3\n";

TEST(Constituents, WithOneMaterialAreOneMaterial) {
  const MaterialScene without =
      material_of_mix(mix_of("material", "", "", "[material]\nE = \"90 GPa\"\nnu = 0.1\nmu = 0.5\n"));
  const MaterialScene with = material_of_mix(mix_of("material", kStiff, kStiff));
  const MacroSpec& a = without.variants.front().setup.spec;
  const MacroSpec& b = with.variants.front().setup.spec;
  EXPECT_TRUE(b.grain_materials.empty());
  EXPECT_EQ(a.youngs_modulus, b.youngs_modulus);
  EXPECT_EQ(a.poisson_ratio, b.poisson_ratio);
  EXPECT_EQ(a.friction, b.friction);
  EXPECT_EQ(a.protocol.friction, b.protocol.friction);
  EXPECT_EQ(a.density, b.density);
  EXPECT_EQ(a.solid_sizes->text(), b.solid_sizes->text());
  EXPECT_EQ(packing_key(a, 1, 0), packing_key(b, 1, 0));
}

TEST(Constituents, GiveTheirMaterialToTheirGrains) {
  const MaterialScene scene = material_of_mix(mix_of("material", kStiff, kSoft, "[packing]\npreparation = \"fast\"\n"));
  const MacroSpec& spec = scene.variants.front().setup.spec;
  ASSERT_EQ(spec.grain_materials.each.size(), 2U);
  EXPECT_EQ(spec.grain_materials.each[0], (GrainMaterial{"sand", 9e10, 0.1, 0.5, 2600.0}));
  EXPECT_NEAR(spec.youngs_modulus, 1.0 / (0.6 / 9e10 + 0.4 / 3e10), 1e3);
  EXPECT_NEAR(spec.poisson_ratio, 0.18, 1e-12);
  EXPECT_EQ(spec.friction, 0.5);
  EXPECT_EQ(spec.protocol.friction, 0.5);  // pairs that have less keep it
  std::array<double, 2> volume{};
  for (const MacroBody& b : drawn_bodies(spec, 1, 0)) {
    volume.at(static_cast<std::size_t>(b.material)) += b.r * b.r * b.r;
    if (b.r > 1.2e-3 * (1.0 + 1e-9)) {
      EXPECT_EQ(b.material, 0);
    }
    if (b.r < 1e-3 * (1.0 - 1e-9)) {
      EXPECT_EQ(b.material, 1);
    }
  }
  EXPECT_NEAR(volume[0] / (volume[0] + volume[1]), 0.6, 0.03);
  EXPECT_NE(packing_key(spec, 1, 0),
            packing_key(material_of_mix(mix_of("material", kStiff, kStiff)).variants.front().setup.spec, 1, 0));
}

/// A constituent without a value has that of [material]; two of one material share it.
TEST(Constituents, TakeWhatTheyDoNotSayFromTheMaterial) {
  const std::string third =
      std::string("[[constituent]]\nname = \"more\"\nmass_share = 0.4\ndensity = 2600\n") + kFillerSizes;
  std::string text = mix_of("material", "E = \"90 GPa\"\n", "", "[material]\nE = \"30 GPa\"\nmu = 0.4\n") + third;
  text.replace(text.find("mass_share = 0.6"), 16, "mass_share = 0.2");
  const MaterialScene scene = material_of_mix(text);
  const auto& each = scene.variants.front().setup.spec.grain_materials.each;
  ASSERT_EQ(each.size(), 2U);
  EXPECT_EQ(each[1], (GrainMaterial{"filler, more", 3e10, 0.3, 0.4, 2600.0}));
  EXPECT_EQ(each[0].friction, 0.4);
}

/// Each packing of a recipe has the mean E of its own grains, and goes to the same stresses over E.
TEST(Constituents, PackingsOfARecipeHaveTheMaterialsOfTheirSizes) {
  const std::string stages =
      "[packing]\nstart_pressure = \"1 MPa\"\n[[stage]]\nkind = \"oedometric\"\nstress = \"60 MPa\"\n";
  const RecipeScene scene = recipe_of(
      mix_of("recipe", kStiff, kSoft, "[levels]\ncut_diameters = [\"2.2 mm\"]\n[check]\ngrains = 3000\n" + stages));
  ASSERT_EQ(scene.levels.size(), 2U);
  EXPECT_NEAR(scene.youngs_modulus, 5e10, 1e3);
  const auto e_of = [](const std::vector<SizePiece>& pieces) {
    double volume = 0.0;
    double stiff = 0.0;
    for (const SizePiece& p : pieces) {
      volume += p.volume;
      stiff += p.material == 0 ? p.volume : 0.0;
    }
    return volume / (stiff / 9e10 + (volume - stiff) / 3e10);
  };
  for (const MaterialVariant& v : scene.material.variants) {
    const MacroSpec& spec = v.setup.spec;
    EXPECT_NEAR(spec.youngs_modulus / e_of(spec.solid_sizes->pieces()), 1.0, 1e-12) << v.name;
    EXPECT_EQ(spec.start_pressure, scene.material.variants.front().setup.spec.start_pressure) << v.name;
    EXPECT_NEAR(spec.start_pressure * scene.youngs_modulus, 1e6, 1.0);
    if (v.same_packings) continue;
    EXPECT_NEAR(*spec.stages.front().target_stress() / spec.youngs_modulus, 6e7 / scene.youngs_modulus, 1e-12)
        << v.name;
  }
  const auto mean_of = [&](std::size_t variant) { return scene.material.variants[variant].setup.spec.youngs_modulus; };
  EXPECT_GT(mean_of(scene.slice[0]), 7e10);  // nearly all sand
  EXPECT_LT(mean_of(scene.slice[1]), 5e10);
  EXPECT_GT(mean_of(scene.mixed[0].front()), mean_of(scene.mixed[0].back()));
  // Level 2 holds both: grains of each share in proportion.
  const MacroSpec& fines = scene.material.variants[scene.slice[1]].setup.spec;
  std::array<double, 2> volume{};
  for (const MacroBody& b : drawn_bodies(fines, 1, 0))
    volume.at(static_cast<std::size_t>(b.material)) += b.r * b.r * b.r;
  EXPECT_NEAR((volume[0] + volume[1]) / (volume[0] / 9e10 + volume[1] / 3e10), fines.youngs_modulus, 2e9);
}

/// Levels of the same shape are two packings when they are of other materials.
TEST(Constituents, EqualShapesOfOtherMaterialsAreOtherPackings) {
  const auto text = [](const std::string& first, const std::string& second) {
    return "kind = \"recipe\"\n[grains]\ncount = 900\n[check]\ngrains = 0\n[levels]\ncut_diameters = [\"2 mm\"]\n"
           "[[constituent]]\nname = \"a\"\nmass_share = 0.5\nsizes = { form = \"power-law\", exponent = 3.5, "
           "radius_min = "
           "\"1 mm\", radius_max = \"2 mm\" }\n" +
           first +
           "[[constituent]]\nname = \"b\"\nmass_share = 0.5\nsizes = { form = \"power-law\", exponent = 3.5, "
           "radius_min = "
           "\"0.5 mm\", radius_max = \"1 mm\" }\n" +
           second;
  };
  const RecipeScene alike = recipe_of(text(kStiff, kStiff));
  EXPECT_EQ(alike.slice[0], alike.slice[1]);
  const RecipeScene unlike = recipe_of(text(kStiff, kSoft));
  EXPECT_NE(unlike.slice[0], unlike.slice[1]);
}

TEST(Constituents, RefuseWhatCannotBe) {
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(refusal_of(text).find(part), std::string::npos) << part << "\n" << refusal_of(text);
  };
  for (const std::string kind : {"material", "recipe"}) {
    expect(mix_of(kind, "E = -1.0\n", ""), "E");
    expect(mix_of(kind, "nu = 0.7\n", ""), "nu");
    expect(mix_of(kind, "mu = -0.1\n", ""), "mu");
    expect(mix_of(kind, "kr_ratio = 1.0\n", ""), "all grains have one resistance to rolling");
    expect(mix_of(kind, "youngs = 1e9\n", ""), "youngs");
    expect(mix_of(kind, kStiff, kSoft, "[material]\nE = 1e9\n"), "every [[constituent]] gives its own");
    expect(mix_of(kind, kStiff, kSoft, "[packing]\npreparation = \"lammps\"\n"), "lammps");
  }
  expect(mix_of("material", kStiff, kSoft) + "[[variant]]\nname = \"v\"\nE = 1e9\n",
         "every [[constituent]] has its own, in all variants");
  expect(mix_of("material", "", "") + "[[variant]]\nname = \"v\"\nratio = 2.0\n", "goes without [[constituent]]");
  expect(mix_of("recipe", kStiff, kSoft, "[shells]\nlevels = 2\n"), "soft particles hold grains of one material");
  // What is wrong is told, and not what would follow from another E.
  const std::string pressed =
      "[packing]\nstart_pressure = \"1 MPa\"\n[[stage]]\nkind = \"oedometric\"\nstress = \"60 MPa\"\n";
  for (const std::string kind : {"material", "recipe"})
    for (const std::string& wrong :
         {mix_of(kind, "E = \"90 GPa\"\nnu = 0.7\nmu = 0.5\n", kSoft, pressed), mix_of(kind, "E = -1.0\n", "", pressed),
          mix_of(kind, "", "", "[material]\nE = -1.0\n" + pressed)}) {
      EXPECT_NE(refusal_of(wrong), "");
      EXPECT_EQ(refusal_of(wrong).find("start_pressure"), std::string::npos) << refusal_of(wrong);
      EXPECT_EQ(refusal_of(wrong).find("stress"), std::string::npos) << refusal_of(wrong);
    }
  std::string many = "kind = \"material\"\n[grains]\ncount = 900\n";
  for (int k = 0; k < 10; ++k)
    many += "[[constituent]]\nname = \"c" + std::to_string(k) +
            "\"\nmass_share = 0.1\nE = " + std::to_string(1000 + k) + ".0\n" + kSandSizes;
  expect(many, "10 materials (E, nu, mu, density); allowed: up to 9");
}

}  // namespace
}  // namespace softgrain
