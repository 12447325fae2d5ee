// softgrain run of kind "macro-comparison": what it writes, that it goes on after a stop, and wrong scenes.
#include <gtest/gtest.h>

#include <filesystem>

#include "common/contact/make_laws.h"
#include "common/data/macro_result.h"
#include "common/io/text_file.h"
#include "tests/support/markup_check.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/synthetic_multi_contact.h"
#include "tests/support/synthetic_run.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/tiny_comparison.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
namespace fs = std::filesystem;

class MacroComparison : public ::testing::Test {
 protected:
  void SetUp() override {
    save_card(synthetic::card(), directory_.file("law.toml"));
    write_text_atomic(scene(), kTinyComparison);
  }
  [[nodiscard]] std::string scene() const { return directory_.file("scene.toml"); }
  [[nodiscard]] std::string out(const std::string& name = "out") const { return directory_.file(name); }
  [[nodiscard]] ProgramOutcome run(const std::string& name, const std::string& more = "") const {
    return run_the_program("run '" + scene() + "' --quiet --out '" + out(name) + "' " + more);
  }
  void expect_refused(const std::string& from, const std::string& to, const std::vector<std::string>& words) const {
    std::string text = kTinyComparison;
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write_text_atomic(scene(), text.replace(at, from.size(), to));
    const ProgramOutcome outcome = run("bad");
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    for (const std::string& word : words)
      EXPECT_NE(outcome.output.find(word), std::string::npos) << word << " in " << outcome.output;
  }

  TemporaryDirectory directory_;
};

TEST_F(MacroComparison, EveryEngineOnEveryScene) {
  const ProgramOutcome outcome = run("out");
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const auto curves = load_macro(out() + "/macro_oedometric-35.h5");
  ASSERT_EQ(curves.size(), 6U);  // three engines, two samples
  EXPECT_EQ(curves[0].engine, "pair");
  EXPECT_EQ(curves[2].engine, "shelled");
  EXPECT_EQ(curves[4].engine, "free");
  for (const MacroCurve& c : curves) EXPECT_FALSE(c.body_forces.empty());
  EXPECT_EQ(load_macro(out() + "/macro_shear-35.h5").size(), 3U);
  const auto summary = nlohmann::json::parse(read_text(out() + "/summary.json"));
  ASSERT_EQ(summary["scenes"].size(), 2U);
  const auto& pair = summary["scenes"][0]["engines"][0];
  EXPECT_EQ(pair["engine"], "pair");
  for (const char* twin : {"against_shelled", "against_free"}) {
    EXPECT_GT(pair[twin]["stress_error"]["mean"].get<double>(), 0.0);
    EXPECT_GT(pair[twin]["speedup_contact_evaluations"].get<double>(), 1.0);
  }
  EXPECT_TRUE(summary["scenes"][1]["engines"][0]["against_shelled"]["deviator_error"].is_object());
  EXPECT_EQ(summary["scenes"][0]["samples"].size(), 2U);
  EXPECT_EQ(nlohmann::json::parse(read_text(out() + "/comparison.json"))["scenes"], summary["scenes"]);
  const std::string report = read_text(out() + "/report.html");
  EXPECT_NE(report.find("aria-label=\"Error against cost\""), std::string::npos);
  EXPECT_NE(report.find("oedometric-35"), std::string::npos);
  EXPECT_EQ(unbalanced_tags(report), "");
  EXPECT_NE(read_text(out() + "/table.md").find("| shear-35 | free | 1 |"), std::string::npos);
  EXPECT_NE(read_text(out() + "/table.csv").find("oedometric-35,pair,2,"), std::string::npos);
  EXPECT_FALSE(fs::exists(out() + "/work"));
}

/// Without twins soft particles hold what the law of the scene was measured on.
TEST_F(MacroComparison, ASceneMayHaveALawOfItsOwn) {
  LawTable table{1, {synthetic::law_entry(0.58)}};
  table.entries[0].grains = 1000.0;
  save_law_table(table, directory_.file("levels.toml"), build_provenance());
  write_text_atomic(scene(), std::string(kTinyComparison) +
                                 "resolved = []\nname = \"levels\"\n[scene.law]\ntable = \"levels.toml\"\nforms = "
                                 "[\"isotropic\"]\n");
  const ProgramOutcome outcome = run("out");
  ASSERT_TRUE(outcome.status == 0 || outcome.status == 3) << outcome.output;
  const auto summary = nlohmann::json::parse(read_text(out() + "/summary.json"));
  const auto& common = summary["scenes"][0];
  const auto& own = summary["scenes"][1];
  EXPECT_EQ(common["engines"][0]["engine"], "pair");
  EXPECT_EQ(own["engines"][0]["engine"], "isotropic");
  const auto& facts = own["samples"][0];
  EXPECT_EQ(facts["inner_grains"], 1000 * facts["soft"].get<int>());
  const double bodies = facts["body_fraction"];
  const double soft = facts["soft_share"];
  EXPECT_NEAR(facts["solid_fraction"].get<double>(), bodies * (1.0 - soft + 0.58 * soft), 1e-12);
}

TEST_F(MacroComparison, ThreadsDoNotMatter) {
  ASSERT_EQ(run("one", "--threads 1").status, 0);
  ASSERT_EQ(run("three", "--threads 3").status, 0);
  const auto a = load_macro(out("one") + "/macro_shear-35.h5");
  const auto b = load_macro(out("three") + "/macro_shear-35.h5");
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].stress_axial, b[k].stress_axial);
    EXPECT_EQ(a[k].body_forces, b[k].body_forces);
  }
}

TEST_F(MacroComparison, AStoppedOneGoesOnToTheSameBits) {
  ASSERT_EQ(run("whole").status, 0);
  const auto begun = [&] { return fs::exists(fs::path(out("stopped")) / "work" / "oedometric-35-shelled-1.h5"); };
  const auto start = [&] {
    return start_program({"run", scene(), "--quiet", "--threads", "1", "--out", out("stopped")});
  };
  ASSERT_TRUE(interrupted_in_the_middle(start, begun, out("stopped")));
  ASSERT_EQ(run("stopped", "--resume").status, 0);
  for (const char* name : {"/macro_oedometric-35.h5", "/macro_shear-35.h5"}) {
    const auto a = load_macro(out("whole") + name);
    const auto b = load_macro(out("stopped") + name);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_EQ(a[k].strain, b[k].strain);
      EXPECT_EQ(a[k].stress_axial, b[k].stress_axial);
      EXPECT_EQ(a[k].body_forces, b[k].body_forces);
      EXPECT_EQ(a[k].cost.contact_evaluations, b[k].cost.contact_evaluations);
    }
  }
}

TEST_F(MacroComparison, CheckSaysWhatItWillDo) {
  const ProgramOutcome outcome = run_the_program("check '" + scene() + "'");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("2 scenes"), std::string::npos) << outcome.output;
}

TEST_F(MacroComparison, AnAbsentCardIsNamed) {
  const ProgramOutcome outcome = run("out", "--set law.card=absent.toml");
  EXPECT_EQ(outcome.status, 4);
  EXPECT_NE(outcome.output.find("absent.toml"), std::string::npos) << outcome.output;
}

/// As of a card: a table of soft particles that hold other grains.
TEST_F(MacroComparison, ATableOfOtherSoftParticlesIsSaid) {
  std::string text = kTinyComparison;
  text.replace(text.find("card = \"law.toml\""), 17,
               "table = \"" SOFTGRAIN_SOURCE_DIR "/tests/reference/law/two_fractions.toml\"\nrange = \"clamp\"");
  write_text_atomic(scene(), text.substr(0, text.rfind("[[scene]]")));
  const ProgramOutcome outcome = run("out", "--set macro.resolved=false --set macro.steps=1");
  ASSERT_TRUE(outcome.status == 0 || outcome.status == 3) << outcome.output;
  EXPECT_NE(read_text(out() + "/summary.json").find("the law table was measured on soft particles of another packing"),
            std::string::npos);
}

TEST_F(MacroComparison, WrongScenesAreRefused) {
  expect_refused("test = \"shear\"", "test = \"sheer\"", {"scene.toml:22", "shear"});
  expect_refused("test = \"shear\"", "samples = 1", {"another scene is called 'oedometric-35'"});
  expect_refused("samples = 2", "resolved = [\"shell\"]", {"unknown twin 'shell'", "shelled"});
  expect_refused("samples = 2", "name = \"a b\"", {"letters, digits"});
  expect_refused("samples = 2", "soft_share = 1.0", {"soft_share = 1:", "voids"});
  expect_refused("bodies = 10", "bodys = 10", {"'bodys'", "'bodies'"});
  expect_refused("soft_polydispersity = 2.0", "soft_polydispersity = 1.1\nsolid_fill = 0.4", {"hold at most"});
}

}  // namespace
