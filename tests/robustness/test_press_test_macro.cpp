// From the table of a press test to a macro run in one command: the law, its unloading branch and its bands.
#include <gtest/gtest.h>

#include <filesystem>

#include "common/data/law_card.h"
#include "common/data/macro_result.h"
#include "common/io/text_file.h"
#include "pipelines/law/law_library_press.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
using nlohmann::json;

const std::string kTable = std::string(SOFTGRAIN_SOURCE_DIR) + "/pipelines/press_test_unloading.csv";

constexpr const char* kScene = R"(kind = "macro"
[macro]
bodies = 30
start_pressure = 1e-3
resolved = false
[[stage]]
kind = "oedometric"
strain = 0.06
steps = 3
[[stage]]
kind = "unload"
strain = 0.01
steps = 2
)";

class PressTestMacro : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return directory_.file(name); }
  ProgramOutcome macro(const std::string& name, const std::string& law, const std::string& lines,
                       const std::string& more = "") {
    write_text_atomic(file(name + ".toml"), lines + kScene);
    return run_the_program("macrosim '" + file(name + ".toml") + "' --quiet --threads 1 --law '" + law + "' --out '" +
                           file(name) + "' " + more);
  }
  MacroCurve curve(const std::string& name, const std::string& law, const std::string& lines = "") {
    const ProgramOutcome outcome = macro(name, law, lines);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return load_macro(file(name) + "/macro.h5").at(0);
  }
  /// The law that the table was made from.
  std::string truth() {
    LawCard card = card_of_press_test(kTable);
    for (PairLaw& law : card.pairs) {
      const double stretch = law.kind == PairKind::soft_solid ? 1.0 : 2.0;
      law.normal.b.value = 2.799;
      law.normal.a.value = 73.669 / 128.0 * std::pow(stretch, -2.799);
      law.normal.delta.value = 0.065 * stretch;
      law.normal.c.value = -law.normal.a.value * std::pow(law.normal.delta.value, 2.799);
      law.unloading->residual.value = 0.1;
      law.unloading->exponent.value = 2.8;
    }
    save_card(card, file("true_law.toml"));
    return file("true_law.toml");
  }

  TemporaryDirectory directory_;
};

TEST_F(PressTestMacro, OneCommandFitsTheLawAndLeavesIt) {
  const MacroCurve direct = curve("direct", kTable);
  const PairLaw* law = load_card(file("direct") + "/law.toml").find(PairKind::soft_solid);
  ASSERT_NE(law, nullptr);
  EXPECT_TRUE(law->unloading);
  const json summary = json::parse(read_text(file("direct") + "/summary.json"));
  EXPECT_NE(summary["remarks"].dump().find("constant force offset"), std::string::npos) << summary["remarks"];
  EXPECT_NE(summary["remarks"].dump().find("comes back"), std::string::npos);
  EXPECT_EQ(summary.dump().find("has no unloading branch"), std::string::npos);
  const MacroCurve again = curve("again", file("direct") + "/law.toml");
  EXPECT_EQ(direct.stress_axial.size(), again.stress_axial.size());
  EXPECT_NEAR(again.stress_axial.back() / direct.stress_axial.back(), 1.0, 1e-6) << "cards hold few digits less";
}

TEST_F(PressTestMacro, TheBranchFallsFasterThanLoading) {
  const MacroCurve with = curve("with", kTable);
  const MacroCurve without = curve("without", kTable, "unloading = false\n");
  EXPECT_NEAR(
      with.stress_axial.at(with.stress_axial.size() - 3) / without.stress_axial.at(without.stress_axial.size() - 3),
      1.0, 0.1)
      << "at the end of loading little has unloaded yet";
  EXPECT_LT(with.stress_axial.back(), without.stress_axial.back());
  EXPECT_NE(read_text(file("without") + "/summary.json").find("has no unloading branch"), std::string::npos);
}

TEST_F(PressTestMacro, TheTruthLiesWithinTheBand) {
  const ProgramOutcome outcome = macro("banded", kTable, "", "--bands 16");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const MacroCurve truth_curve = curve("truth", truth());
  bool seen = false;
  const json summary = json::parse(read_text(file("banded") + "/summary.json"));
  for (const json& end : summary["band_ends"]) {
    if (end["of"] != "axial") continue;
    seen = true;
    EXPECT_LE(end["low"].get<double>(), truth_curve.stress_axial.back());
    EXPECT_GE(end["high"].get<double>(), truth_curve.stress_axial.back());
  }
  EXPECT_TRUE(seen);
}

TEST_F(PressTestMacro, MistakesAreRefused) {
  write_text_atomic(file("few.csv"),
                    "# kind = soft-solid\n# Rs = 16 mm\nhn [mm]; Fn [N]\n1; 1\n2; 2\n3; 3\n4; 4\n5; 5\n");
  const ProgramOutcome modulus = macro("modulus", file("few.csv"), "");
  EXPECT_EQ(modulus.status, 2);
  EXPECT_NE(modulus.output.find("E of the grains is needed"), std::string::npos) << modulus.output;
  EXPECT_EQ(modulus.output.find("--modulus"), std::string::npos) << "no option of this command: " << modulus.output;
  EXPECT_NE(modulus.output.find("press_test.csv"), std::string::npos) << modulus.output;
  const ProgramOutcome absent = macro("absent", file("absent.csv"), "");
  EXPECT_EQ(absent.status, 4) << absent.output;
}

}  // namespace
