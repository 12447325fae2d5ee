// softgrain run of kind "hierarchy": what it writes, other threads, a stop on the way, wrong scenes.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "common/data/multi_contact_law.h"
#include "common/io/scene.h"
#include "common/io/text_file.h"
#include "pipelines/kinds/hierarchy/scene.h"
#include "tests/support/markup_check.h"
#include "tests/support/process.h"
#include "tests/support/program.h"
#include "tests/support/temporary_directory.h"
#include "tests/support/tiny_hierarchy.h"

namespace {

using namespace softgrain;
using namespace softgrain::test;
using nlohmann::json;
namespace fs = std::filesystem;

class Hierarchy : public ::testing::Test {
 protected:
  Hierarchy() { write_text_atomic(scene(), kTinyHierarchy); }

  [[nodiscard]] std::string scene() const { return directory_.file("scene.toml"); }
  [[nodiscard]] std::string out(const std::string& name) const { return directory_.file(name); }
  /// What a run found: its summary without times and places.
  json run(const std::string& name, const std::string& more) {
    const ProgramOutcome outcome = run_the_program("run '" + scene() + "' --quiet --out '" + out(name) + "' " + more);
    EXPECT_EQ(outcome.status, 3) << outcome.output;
    json s = json::parse(read_text(out(name) + "/summary.json"));
    s.erase("seconds");
    s.erase("files");
    s.erase("provenance");
    s.erase("command");
    for (json& level : s["levels"]) level.erase("seconds");
    if (s.contains("check"))
      for (const char* time : {"law_seconds", "resolved_seconds"}) s["check"].erase(time);
    return s;
  }
  void expect_refused(const std::string& from, const std::string& to, const std::vector<std::string>& words) {
    std::string text = kTinyHierarchy;
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write_text_atomic(scene(), text.replace(at, from.size(), to));
    const ProgramOutcome outcome = run_the_program("run '" + scene() + "' --out '" + out("bad") + "'");
    EXPECT_EQ(outcome.status, 2) << outcome.output;
    EXPECT_TRUE(!fs::exists(out("bad")) || fs::is_empty(out("bad")));
    for (const std::string& word : words)
      EXPECT_NE(outcome.output.find(word), std::string::npos) << word << " not in " << outcome.output;
  }

  test::TemporaryDirectory directory_;
};

TEST_F(Hierarchy, LevelsOnTopOfLevels) {
  const json s = run("out", "");
  ASSERT_EQ(s["levels"].size(), 2U);
  EXPECT_FALSE(s["levels"][0].contains("inner"));
  const double inner = s["levels"][1]["inner"]["mean"];
  EXPECT_GE(inner, 4.0);
  EXPECT_NEAR(s["levels"][1]["inner"]["next_volume"].get<double>(), std::sqrt(1.0 / 3.0), 0.1);
  EXPECT_LT(s["levels"][1]["grain_percent"], s["levels"][0]["grain_percent"]);
  EXPECT_FALSE(s["levels"][0].contains("sensitivity"));
  EXPECT_GE(s["levels"][1]["sensitivity"]["value"], 0.0);
  EXPECT_GT(s["levels"][1]["sensitivity"]["error"], 0.0);
  EXPECT_EQ(s["levels"][1]["changes"].size(), 3U);
  EXPECT_GT(s["levels"][1]["changes"][0]["ratio"].get<double>(), 0.0);
  const double grains = s["levels"][0]["resolved_grains"];
  EXPECT_GT(s["levels"][1]["resolved_grains"].get<double>(), inner * grains);
  EXPECT_EQ(s["fixed_point"]["reached"].get<bool>(), s["levels"][1]["distance_percent"].get<double>() <= 90.0);
  EXPECT_EQ(s["check"]["points"].size(), 2U);
  EXPECT_GE(s["check"]["inner"], 4.0);
  EXPECT_GT(s["check"]["grains"].get<double>(), grains);
  EXPECT_GT(s["check"]["resolved_contact_evaluations"], s["check"]["law_contact_evaluations"]);
  for (const char* file : {"law_table_level_0.toml", "law_table_level_1.toml", "law_table.toml"}) {
    const LawTable table = load_law_table(out("out") + "/" + file);
    ASSERT_EQ(table.entries.size(), 1U);
    EXPECT_NE(table.entries[0].find(LawForm::isotropic), nullptr);
  }
  EXPECT_TRUE(fs::exists(out("out") + "/multi_contact_level_1.h5"));
  EXPECT_EQ(unbalanced_tags(read_text(out("out") + "/report.html")), "");
  EXPECT_FALSE(fs::exists(out("out") + "/work"));
}

TEST_F(Hierarchy, ThreadsDoNotMatter) { EXPECT_EQ(run("one", "--threads 1"), run("two", "--threads 2")); }

TEST_F(Hierarchy, AStoppedRunGoesOnWithTheSameBits) {
  const auto begun = [&] { return fs::exists(out("stopped") + "/law_table_level_0.toml"); };
  const auto start = [&] {
    return start_program({"run", scene(), "--out", out("stopped"), "--threads", "1", "--quiet"});
  };
  ASSERT_TRUE(interrupted_in_the_middle(start, begun, out("stopped")));
  EXPECT_FALSE(fs::exists(out("stopped") + "/law_table.toml"));
  const json resumed = run("stopped", "--resume");
  EXPECT_EQ(run("whole", "--threads 1"), resumed);
}

TEST_F(Hierarchy, CheckSaysWhatFollows) {
  const ProgramOutcome outcome = run_the_program("check '" + scene() + "'");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_NE(outcome.output.find("2 levels, up to 2"), std::string::npos) << outcome.output;
}

TEST_F(Hierarchy, WrongScenesAreRefused) {
  expect_refused("levels = 2", "levels = 1", {"levels = 1", "2"});
  expect_refused("inner_radius = 0.3", "inner_radius = 0.7", {"inner_radius = 0.7", "0.5"});
  expect_refused("inner_radius = 0.3", "next_volume = 0.0", {"next_volume = 0"});
  expect_refused("form = \"isotropic\"", "form = \"bog\"", {"form", "isotropic"});
  expect_refused("iterations = 2", "iterations = 1", {"iterations = 1"});
  expect_refused("overlaps = [0.2, 0.3]", "overlaps = [0.3, 0.2]", {"overlaps", "must ascend"});
  expect_refused("replicates = 4", "repliactes = 4", {"'repliactes'", "'replicates'"});
  expect_refused("packings = 2", "packings = 20", {"packings = 20"});
  std::string all = kTinyHierarchy;
  const std::string key = "packings = 2\n";
  all.erase(all.find(key), key.size());
  EXPECT_EQ(read_hierarchy_setup(Scene::parse(all, "h.toml")).check_packings, 4)
      << "[check] without the key takes as many packings as every configuration has";
  expect_refused("packings_max = 4", "packings_max = 3", {"packings_max"});
}

TEST_F(Hierarchy, TheVoidsOfThePublishedPackingsHoldLess) {
  const json masses = run("masses", "--set check.packings=0");
  const json voids =
      run("voids", "--set check.packings=0 --set hierarchy.fill=voids --set hierarchy.inner_radius_min=0.1");
  EXPECT_EQ(voids["levels"][1]["grain_percent"], voids["levels"][0]["grain_percent"]);
  EXPECT_LT(voids["levels"][1]["inner"]["next_volume"], masses["levels"][1]["inner"]["next_volume"]);
  EXPECT_GT(voids["levels"][1]["solid_percent"], masses["levels"][1]["solid_percent"]);
  expect_refused("inner_radius = 0.3", "inner_radius = 0.3\ninner_radius_min = 0.1", {"inner_radius_min", "voids"});
}

TEST_F(Hierarchy, EveryKindOfNeighbourIsNeeded) {
  expect_refused("partner = \"plane\"", "partner = \"plane\"\nheld_out = true", {"configuration", "plane partner"});
  expect_refused("partner = \"solid\"\nratio = 1.0", "partner = \"soft\"\nratio = 2.0",
                 {"configuration", "solid partner"});
  expect_refused("arrangement = \"one\"\npartner = \"soft\"", "arrangement = \"opposite\"\npartner = \"soft\"",
                 {"configuration", "soft partner"});
}

}  // namespace
