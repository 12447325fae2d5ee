// Materials that are prepared to a density: each sample meets it, one that cannot leaves the other variants alone.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/data/macro_result.h"
#include "common/io/text_file.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/unwrapped.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr const char* kDensityScene = R"(kind = "material"
seed = 1
samples = 2
[material]
mu = 0.5
density = 2650
[grains]
count = 150
ratio = 2.0
[packing]
preparation = "fast"
solid_fraction_tolerance = 0.004
solid_fraction = 0.61
[test]
test = "oedometric"
strain = 0.005
steps = 1
)";

class MaterialDensity : public ::testing::Test {
 protected:
  [[nodiscard]] ProgramOutcome run(const std::string& text, const std::string& name, const std::string& more = "") {
    write_text_atomic(file("scene.toml"), text);
    ProgramOutcome outcome =
        run_the_program("run '" + file("scene.toml") + "' --quiet --threads 1 --out '" + file(name) + "' " + more);
    outcome.output = unwrapped(outcome.output);
    return outcome;
  }
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }
  [[nodiscard]] nlohmann::json summary(const std::string& name) const {
    return nlohmann::json::parse(read_text(file(name) + "/summary.json"));
  }
  static void expect_words(const ProgramOutcome& outcome, int status, const std::vector<std::string>& words) {
    EXPECT_EQ(outcome.status, status) << outcome.output;
    for (const std::string& word : words)
      EXPECT_NE(outcome.output.find(word), std::string::npos) << word << " not in " << outcome.output;
  }

  TemporaryDirectory directory_;
};

TEST_F(MaterialDensity, EverySampleOfEveryVariantMeetsItsTarget) {
  const std::string text = std::string(kDensityScene) +
                           "[[variant]]\nname = \"as-fraction\"\n[[variant]]\nname = "
                           "\"as-mass\"\ndry_density = \"1.59 g/cm^3\"\n";
  expect_words(run(text, "run"), 0, {"target solid fraction 0.61 +- 0.004", "target solid fraction 0.6 +- 0.004"});
  const nlohmann::json variants = summary("run")["variants"];
  ASSERT_EQ(variants.size(), 2U);
  const std::vector<double> targets{0.61, 0.60};
  for (std::size_t v = 0; v < 2; ++v) {
    ASSERT_EQ(variants[v]["target_density"]["samples"].size(), 2U);
    for (const nlohmann::json& s : variants[v]["target_density"]["samples"])
      EXPECT_NEAR(s["solid_fraction"].get<double>(), targets[v], 0.004);
  }
  for (const MacroCurve& c : load_macro(file("run") + "/material_as-mass.h5")) {
    ASSERT_TRUE(c.density);
    EXPECT_NEAR(c.solid_fraction, 0.60, 0.004);
    EXPECT_GT(c.density->friction, 0.05);
  }
  EXPECT_NE(read_text(file("run") + "/report.html").find("target solid fraction"), std::string::npos);
}

TEST_F(MaterialDensity, ATargetOutOfReachLeavesTheOtherVariants) {
  const std::string text = std::string(kDensityScene) +
                           "[[variant]]\nname = \"met\"\n[[variant]]\nname = "
                           "\"beyond\"\nvoid_ratio = 0.2\n";
  EXPECT_EQ(run(text, "run").status, 3);
  const std::string said = read_text(file("run") + "/summary.json");
  for (const char* word : {"packing beyond: void_ratio = 0.2 (solid fraction 0.8333 +- 0.004) cannot be reached",
                           "void_ratio from", "without"})
    EXPECT_NE(said.find(word), std::string::npos) << word << " not in " << said;
  EXPECT_EQ(said.find("more preparation_passes"), std::string::npos) << "no advice that does not help";
  ASSERT_EQ(summary("run")["variants"].size(), 1U);
  EXPECT_EQ(summary("run")["variants"][0]["name"], "met");
}

/// The same mass in a box is another solid fraction where the grains are heavier: 0.61 of grains of 3,000 kg/m^3 in the
/// mean.
TEST_F(MaterialDensity, DryDensityOfAMixGoesByTheMeanDensityOfItsConstituents) {
  std::string text = kDensityScene;
  text.replace(text.find("density = 2650\n"), 15, "");
  text.replace(text.find("ratio = 2.0\n"), 12, "");
  text.replace(text.find("solid_fraction = 0.61"), 21, "dry_density = 1830");
  const std::string sizes = "sizes = { form = \"power-law\", exponent = 3.5, radius_min = 5e-4, radius_max = 1e-3 }\n";
  text += "[[constituent]]\nname = \"light\"\ndensity = 2000\nmass_share = 0.333333333333\n" + sizes +
          "[[constituent]]\nname = \"heavy\"\ndensity = 4000\nmass_share = 0.666666666667\n" + sizes;
  expect_words(run(text, "alike", "--set samples=1"), 0, {});
  EXPECT_NEAR(load_macro(file("alike") + "/material.h5")[0].solid_fraction, 0.61, 0.0041);
  text.replace(text.rfind("density = 4000"), 14, "density = 4000\nE = 1e6");
  expect_words(run(text, "stiff", "--set samples=1"), 0, {});
  EXPECT_NEAR(load_macro(file("stiff") + "/material.h5")[0].solid_fraction, 0.61, 0.0041);
}

/// Without the key nothing of it is said, and the packing is that of a search that ends at once.
TEST_F(MaterialDensity, WithoutATargetNothingChanges) {
  std::string plain = kDensityScene;
  plain.erase(plain.find("solid_fraction_tolerance"), plain.find("[test]") - plain.find("solid_fraction_tolerance"));
  expect_words(run(plain, "plain"), 0, {});
  EXPECT_FALSE(summary("plain")["variants"][0].contains("target_density"));
  const std::vector<MacroCurve> curves = load_macro(file("plain") + "/material.h5");
  EXPECT_FALSE(curves[0].density);
  std::string found = kDensityScene;
  found.replace(found.find("0.61"), 4, std::to_string(curves[0].solid_fraction));
  expect_words(run(found, "found", "--set samples=1"), 0, {});
  const std::vector<MacroCurve> searched = load_macro(file("found") + "/material.h5");
  EXPECT_EQ(searched[0].stress_axial, curves[0].stress_axial);
  EXPECT_EQ(searched[0].density->tries, 1);
  EXPECT_EQ(searched[0].density->friction, 0.5);
}

TEST_F(MaterialDensity, IsRefusedWhereItHasNoMeaning) {
  std::string text = kDensityScene;
  text.replace(text.find("\"fast\""), 6, "\"vibrated\"");
  expect_words(run(text, "run"), 2, {"scene.toml:13", "solid_fraction", "compaction_mu above 0"});
  std::string recipe = kDensityScene;
  recipe.replace(recipe.find("\"material\""), 10, "\"recipe\"");
  expect_words(run(recipe, "run"), 2, {"scene.toml:13", "solid_fraction", "differ in density"});
  std::string law = kDensityScene;
  law.replace(law.find("\"material\""), 10, "\"material-law\"");
  expect_words(run(law, "run"), 2, {"scene.toml:13", "solid_fraction", "differ in density"});
}

}  // namespace
