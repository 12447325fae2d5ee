// The kind "recipe" as a whole: files, the check with all grains, and a second run out of the caches.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include "common/data/cell_card.h"
#include "common/data/macro_result.h"
#include "common/io/text_file.h"
#include "tests/support/every_kind.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

std::string run_tiny(const TemporaryDirectory& directory, const std::string& out, const std::string& more) {
  const std::string path = directory.file(out);
  const ProgramOutcome outcome =
      run_the_program("run '" + directory.file("scene.toml") + "' --out '" + path + "' " + more);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  return path;
}

std::size_t files_named(const std::string& directory, const std::string& prefix) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(directory))
    count += entry.path().filename().string().starts_with(prefix) ? 1 : 0;
  return count;
}

TEST(RecipeRun, HoldsForAllItsGrainsAndRunsAgainOutOfTheCaches) {
  const TemporaryDirectory directory;
  write_text_atomic(directory.file("scene.toml"), starter_scene("recipe"));
  const std::string caches =
      "--packing-cache '" + directory.file("packings") + "' --law-cache '" + directory.file("tests") + "' ";
  const std::string first = run_tiny(directory, "first", caches);
  const nlohmann::json summary = summary_of(first);
  const nlohmann::json& r = summary["recipe"];
  EXPECT_EQ(r["levels"].size(), 2U);
  EXPECT_NEAR(r["levels"][0]["volume_share"].get<double>() + r["levels"][1]["volume_share"].get<double>(), 1.0, 1e-9);
  const double onset = r["onset"]["value"];
  EXPECT_GE(onset, r["onset"]["interval"][0]);
  EXPECT_LE(onset, r["onset"]["interval"][1]);
  // All grains, 300 of them, two samples: they scatter by a few per cent.
  EXPECT_NEAR(r["check"]["measured"], onset, 0.02);
  EXPECT_EQ(r["check"]["levels"], 2);
  // The check is the whole here: its K0 is measured, that of the whole is a prediction without it.
  EXPECT_EQ(r["check"]["K0"]["value"], r["K0"]["value"]);
  EXPECT_NE(r["check"]["K0"]["measured"]["mean"], r["K0"]["value"]);
  EXPECT_NEAR(r["check"]["K0"]["measured"]["mean"].get<double>(), r["K0"]["value"].get<double>(), 0.2);
  for (const char* file :
       {"material_card.toml", "cell_law.toml", "recipe.csv", "recipe_macro.h5", "material.csv", "report.html"})
    EXPECT_TRUE(std::filesystem::exists(first + "/" + file)) << file;
  const ProgramOutcome checked = run_the_program("check '" + first + "/material_card.toml'");
  EXPECT_EQ(checked.status, 0) << checked.output;
  EXPECT_NE(checked.output.find("card of a whole material of 2 levels"), std::string::npos) << checked.output;
  write_text_atomic(directory.file("macro.toml"), "kind = \"macro\"\n[macro]\nbodies = 20\n");
  const ProgramOutcome refused = run_the_program("macrosim '" + directory.file("macro.toml") + "' --law '" + first +
                                                 "/material_card.toml' --out '" + directory.file("none") + "'");
  EXPECT_EQ(refused.status, 2) << refused.output;
  EXPECT_NE(refused.output.find("take the card of the cell law"), std::string::npos) << refused.output;
  const CellCard card = read_cell_card(first + "/cell_law.toml");
  EXPECT_GT(card.void_ratio.value, 0.0);
  EXPECT_EQ(card.youngs_modulus, 5e5);
  EXPECT_NE(read_text(first + "/material_card.toml").find("\nE = 500000.0"), std::string::npos);
  // Summary, report and compare show the numbers that were written, and those of the pair that was measured apart.
  const std::map<std::string, Estimate> written{{"e_J", card.void_ratio},   {"w_inf", card.excess_many},
                                                {"K", card.modulus},        {"xi", card.excess_decay},
                                                {"e_c", card.excess_alone}, {"mu_f", card.friction}};
  std::size_t shown = 0;
  for (const nlohmann::json& n : summary["cell_law"]["numbers"])
    if (const auto at = written.find(n["name"]); at != written.end()) {
      EXPECT_NEAR(n["value"].get<double>(), at->second.value, 1e-12) << at->first;
      EXPECT_NEAR(n["standard_error"].get<double>(), at->second.standard_error, 1e-12) << at->first;
      ++shown;
    }
  EXPECT_EQ(shown, written.size());
  EXPECT_EQ(summary["cell_law"]["numbers_of_two_coarsest_levels"].size(), summary["cell_law"]["numbers"].size());
  EXPECT_NE(read_text(first + "/report.html").find("of the two coarsest levels alone"), std::string::npos);
  ASSERT_EQ(r["curves"].size(), 3U);
  EXPECT_EQ(r["curves"][1]["name"], "all grains");
  const double law = r["curves"][0]["axial"].back();
  EXPECT_NEAR(r["curves"][1]["axial"].back().get<double>() / law, 1.0, 0.3);
  EXPECT_NEAR(r["curves"][2]["axial"].back().get<double>() / law, 1.0, 0.5);
  // What the runs with the cell law say of themselves is said, as pressures beyond its range.
  for (const MacroCurve& c : load_macro(first + "/recipe_macro.h5"))
    if (c.usable && !c.note.empty() && c.sample == 0) {
      EXPECT_NE(summary["remarks"].dump().find("'" + c.engine + "' of sample 0"), std::string::npos) << c.note;
    }
  const std::string page = read_text(first + "/report.html");
  for (const char* part : {"recipe-onset", "recipe-load", "From the recipe to the law"})
    EXPECT_NE(page.find(part), std::string::npos) << part;

  const std::size_t kept = files_named(directory.file("tests"), "material-");
  EXPECT_EQ(kept, 6U);  // one level and its shear, three mixtures, the check
  const std::string second = run_tiny(directory, "second", caches);
  EXPECT_EQ(read_text(first + "/recipe.csv"), read_text(second + "/recipe.csv"));
  EXPECT_EQ(read_text(first + "/material.csv"), read_text(second + "/material.csv"));
  EXPECT_EQ(files_named(directory.file("tests"), "material-"), kept);
  // Other grains are other tests.
  (void)run_tiny(directory, "third", caches + "--set material.mu=0.31");
  EXPECT_EQ(files_named(directory.file("tests"), "material-"), 2 * kept);
}

TEST(RecipeRun, ReachesTheStressesOfItsStagesAndGivesModuliInPascal) {
  const TemporaryDirectory directory;
  // E is 0.5 MPa, the preparation ends at 50 Pa.
  write_text_atomic(directory.file("scene.toml"), staged_recipe("[[stage]]\nkind = \"oedometric\"\nstress = \"1 kPa\"\n"
                                                                "[[stage]]\nkind = \"unload\"\nstress = \"200 Pa\"\n"
                                                                "[[stage]]\nkind = \"reload\"\n"));
  const std::string out = run_tiny(directory, "out", "");
  const nlohmann::json summary = summary_of(out);
  const nlohmann::json& staged = summary["recipe"]["staged"];
  ASSERT_EQ(staged["stages"].size(), 3U);
  ASSERT_EQ(staged["points"].size(), 13U);  // the start and four of each stage
  const auto stress_end = [&](std::size_t k) { return staged["stages"][k]["axial_stress_end"].get<double>(); };
  EXPECT_NEAR(staged["points"][0]["axial_stress"].get<double>(), 50.0, 2.0);
  EXPECT_NEAR(stress_end(0), 1000.0, 4.0);  // to a third of the tolerance of 1 %
  EXPECT_NEAR(stress_end(1), 200.0, 4.0);
  EXPECT_NEAR(stress_end(2), 1000.0, 4.0);
  for (std::size_t k = 0; k < 3; ++k) {
    const nlohmann::json& s = staged["stages"][k];
    for (const char* key :
         {"modulus_secant", "modulus_begin", "modulus_end", "compression_index", "K0_end", "void_ratio_end"}) {
      const double value = s[key]["value"];
      EXPECT_GT(value, 0.0) << key;
      EXPECT_LE(s[key]["interval"][0].get<double>(), value) << key;
      EXPECT_GE(s[key]["interval"][1].get<double>(), value) << key;
      // The check holds all grains: it lies beside the prediction.
      EXPECT_NEAR(s[key]["measured"]["mean"].get<double>() / value, 1.0, 0.3) << key;
    }
  }
  EXPECT_NE(staged["stages"][0]["K0_end"]["measured"]["mean"], staged["stages"][0]["K0_end"]["value"]);
  // Unloading is stiffer than loading was, and gives back less of the void ratio.
  EXPECT_GT(staged["stages"][1]["modulus_begin"]["value"], staged["stages"][0]["modulus_end"]["value"]);
  EXPECT_LT(staged["stages"][1]["void_ratio_end"]["value"], staged["points"][0]["void_ratio"]["value"]);
  EXPECT_GT(staged["stages"][1]["K0_end"]["value"], staged["stages"][0]["K0_end"]["value"]);
  EXPECT_NE(read_text(out + "/recipe.csv").find("axial [Pa]"), std::string::npos);
  EXPECT_NE(read_text(out + "/recipe_stages.csv").find("void_ratio_low"), std::string::npos);
  EXPECT_NE(read_text(out + "/report.html").find("recipe-void-ratio"), std::string::npos);
  EXPECT_NE(read_text(out + "/report.html").find("MPa</dt><dd>constrained modulus"), std::string::npos)
      << "in its head";
  const ProgramOutcome checked = run_the_program("check '" + directory.file("scene.toml") + "'");
  EXPECT_EQ(checked.status, 0) << checked.output;
  EXPECT_NE(checked.output.find("axial stresses: from 50 Pa, oedometric to 1 kPa, unload to 200 Pa, reload to 1 kPa"),
            std::string::npos)
      << checked.output;
  // Two such recipes: stages by their own stresses, in Pa.
  const std::string other = run_tiny(directory, "other", "--set grains.ratio=2.1");
  const ProgramOutcome compared =
      run_the_program("compare '" + out + "' '" + other + "' --out '" + directory.file("c") + "'");
  EXPECT_EQ(compared.status, 0) << compared.output;
  const std::string differences = read_text(directory.file("c") + "/differences.csv");
  for (const char* name : {"solid fraction at the start", "\"constrained modulus, oedometric\",Pa", "\"Cs, unload\""})
    EXPECT_NE(differences.find(name), std::string::npos) << name << "\n" << differences;
}

}  // namespace
