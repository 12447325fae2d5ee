// The kind "material-law" as a whole: a small material gives a card that reads back; too small a one gives none.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "common/data/cell_card.h"
#include "tests/support/every_kind.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;

constexpr const char* kSmallMaterialLaw = R"(kind = "material-law"
samples = 2
[grains]
count = 400
ratio = 4
[law]
split = 0.4
mixtures = [0.2, 0.5, 0.75]
replicates = 60
cells = 40
shear_strain = 0.04
[packing]
preparation = "fast"
[test]
steps = 4
increments_per_step = 2
strain = 0.06
preload_steps = 1
)";

const nlohmann::json& number_named(const nlohmann::json& law, const std::string& name) {
  for (const auto& n : law["numbers"])
    if (n["name"] == name) return n;
  ADD_FAILURE() << name;
  return law;
}

TEST(MaterialLaw, ASmallMaterialGivesACardThatReadsBack) {
  const TemporaryDirectory directory;
  std::string text = kSmallMaterialLaw;
  text.insert(text.find("cells = 40\n"), "preparations = [\"dense\"]\n");
  write_text_atomic(directory.file("scene.toml"), text);
  const std::string out = directory.file("out");
  const ProgramOutcome outcome = run_the_program("run '" + directory.file("scene.toml") + "' --out '" + out + "'");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("void ratios of fines prepared 'dense' over these: 0."), std::string::npos)
      << outcome.output;
  EXPECT_NE(outcome.output.find("cell law, porosity form: K = "), std::string::npos) << outcome.output;
  const CellCard card = read_cell_card(out + "/cell_law.toml");
  const nlohmann::json summary = summary_of(out);
  const nlohmann::json& law = summary["cell_law"];
  EXPECT_EQ(card.form, StateForm::porosity);
  EXPECT_EQ(card.samples, 2);
  EXPECT_EQ(card.split, 0.4);
  EXPECT_EQ(card.preparation, "fast");
  EXPECT_NEAR(card.fines_ratio, 1.6, 1e-9);
  EXPECT_NEAR(card.mixture_high, 3.0, 0.3);
  EXPECT_LT(card.pressure_low, 2e-4);
  EXPECT_GT(card.pressure_high, 5e-4);
  EXPECT_EQ(card.modulus.value, number_named(law, "K")["value"].get<double>());
  EXPECT_EQ(card.stiffness.high, number_named(law, "chi")["interval"][1].get<double>());
  for (const auto& onset : summary["equation_of_state"]["onsets"]) {
    const double phi = onset["onset"]["value"].get<double>();
    if (onset["name"] == "fines") {
      EXPECT_NEAR(card.void_ratio.value, (1.0 - phi) / phi, 1e-12);
    }
    if (onset["name"] == "coarse") {
      EXPECT_NEAR(card.excess_alone.value, (1.0 - phi) / phi, 1e-12);
    }
    EXPECT_NE(onset["name"], "fines-shear") << "the same packings, tested again";
    EXPECT_NE(onset["name"], "fines-dense") << "prepared only";
  }
  ASSERT_EQ(card.preparations.size(), 1U);
  EXPECT_EQ(card.preparations[0].preparation, "dense");
  EXPECT_EQ(card.preparations[0].factor.value, law["void_ratio_factors"][0]["value"].get<double>());
  EXPECT_GT(card.preparations[0].factor.standard_error, 0.0);
  EXPECT_GT(card.preparations[0].factor.value, 0.65);
  EXPECT_LT(card.preparations[0].factor.value, 0.82);
  // Where numbers of such materials are.
  EXPECT_GT(card.void_ratio.value, 0.6);
  EXPECT_LT(card.void_ratio.value, 0.9);
  EXPECT_LT(card.excess_many.value, card.excess_alone.value);
  EXPECT_GT(card.friction.value, 0.15);
  EXPECT_LT(card.friction.value, 0.7);
  EXPECT_GT(card.lateral_ratio.value, 0.4);
  EXPECT_LT(card.lateral_ratio.value, 0.9);
  EXPECT_LT(card.friction.low, card.friction.value);
  EXPECT_LT(card.excess_decay.low, card.excess_decay.value);
  // Fines that are sheared begin where those that are compressed do.
  for (const auto& v : summary["variants"])
    if (v["name"] == "fines-shear") {
      EXPECT_EQ(v["solid_fraction_start"], summary["variants"][0]["solid_fraction_start"]);
    }
  const std::string page = read_text(out + "/report.html");
  for (const char* part : {"cell-law-pores", "cell-law-lateral", "cell-law-shear", "material-collapse"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  EXPECT_NE(read_text(out + "/material.csv").find("fines-shear,1,shear"), std::string::npos);
}

/// A card with shear memory, and what a scene of coarse grains makes of it.
TEST(MaterialLaw, WithShearMemoryGivesACardForTestsThatShear) {
  const TemporaryDirectory directory;
  std::string text = kSmallMaterialLaw;
  text.replace(text.find("cells = 40\n"), 11, "memory = true\ndense = false\n");
  text.replace(text.find("samples = 2"), 11, "samples = 1");
  write_text_atomic(directory.file("scene.toml"), text);
  const std::string out = directory.file("out");
  const ProgramOutcome outcome = run_the_program("run '" + directory.file("scene.toml") + "' --out '" + out + "'");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const CellCard card = read_cell_card(out + "/cell_law.toml");
  ASSERT_TRUE(card.memory);
  EXPECT_GT(card.exponent.value, 1.3);
  EXPECT_LT(card.exponent.value, 1.9);
  EXPECT_GT(card.friction.value, 0.3);
  EXPECT_LT(card.friction.value, 1.0);
  EXPECT_EQ(card.memory->dilatancy.value, 1.0) << "not measured without dense fines";
  EXPECT_GT(card.memory->critical_pores.value, 0.7);
  EXPECT_LT(card.memory->critical_pores.value, 1.0);
  EXPECT_NEAR(card.memory->strength_range.value, 2.0 / 3.0, 1e-12) << "not measured without dense fines";
  EXPECT_GT(card.memory->least_state.value, 0.0);
  const std::string page = read_text(out + "/report.html");
  for (const char* part : {"cell-law-fines-triaxial-ratio", "cell-law-fines-oedometric-pressure", "critical state"})
    EXPECT_NE(page.find(part), std::string::npos) << part;
  const ProgramOutcome shown = run_the_program("law show '" + out + "/cell_law.toml'");
  EXPECT_NE(shown.output.find("r_c"), std::string::npos) << shown.output;
  write_text_atomic(directory.file("macro.toml"), "kind = \"macro\"\nlaw = \"" + out + R"(/cell_law.toml"
[macro]
bodies = 40
boundary = "periodic"
preparation = "fast"
start_pressure = 1e-4
solid_polydispersity = 3
[fines]
share = 0.4
[[stage]]
kind = "triaxial"
strain = 0.02
steps = 2
[[stage]]
kind = "unload"
strain = 0.005
steps = 1
)");
  const std::string check = "check '" + directory.file("macro.toml") + "'";
  EXPECT_EQ(run_the_program(check).output.find("no shear memory"), std::string::npos);
  const std::string macro = "macrosim '" + directory.file("macro.toml") + "' --out '" + directory.file("macro") + "'";
  const ProgramOutcome run = run_the_program(macro);
  EXPECT_EQ(run.status, 0) << run.output;
  const std::string plain = check + " --set law='" + SOFTGRAIN_SOURCE_DIR + "/results/material_law/cell_law.toml'";
  EXPECT_NE(run_the_program(plain).output.find("no shear memory"), std::string::npos);
}

TEST(SlowMaterialLaw, TooSmallAMaterialGivesNone) {
  const TemporaryDirectory directory;
  write_text_atomic(directory.file("scene.toml"), kTinyMaterialLaw);
  const std::string out = directory.file("out");
  const ProgramOutcome outcome = run_the_program("run '" + directory.file("scene.toml") + "' --out '" + out + "'");
  EXPECT_EQ(outcome.status, 3) << outcome.output;
  EXPECT_NE(outcome.output.find("no cell law: excess pores: "), std::string::npos) << outcome.output;
  EXPECT_FALSE(std::filesystem::exists(out + "/cell_law.toml"));
  const nlohmann::json summary = summary_of(out);
  EXPECT_EQ(summary["status"], "not usable");
  EXPECT_FALSE(summary["cell_law"]["usable"].get<bool>());
}

}  // namespace
